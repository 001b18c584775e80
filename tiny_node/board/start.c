/* Vectors and memory of a Cortex-M3 before main(). */
#include <stdint.h>

extern uint32_t data_from[], data_begin[], data_end[], bss_begin[], bss_end[], stack_top[];
int main(void);
void systick(void);
void start(void);

void start(void) {
  const uint32_t* from = data_from;
  for (uint32_t* to = data_begin; to < data_end; to++) *to = *from++;
  for (uint32_t* to = bss_begin; to < bss_end; to++) *to = 0;
  main();
}

static void stay(void) {
  for (;;) continue;
}

__attribute__((section(".vectors"), used)) static void (*const vectors[16])(void) = {(void (*)(void))stack_top,
                                                                                     start,
                                                                                     stay,
                                                                                     stay,
                                                                                     stay,
                                                                                     stay,
                                                                                     stay,
                                                                                     stay,
                                                                                     stay,
                                                                                     stay,
                                                                                     stay,
                                                                                     stay,
                                                                                     stay,
                                                                                     stay,
                                                                                     stay,
                                                                                     systick};
