/* Vectors and memory of a Cortex-M3 before main(). */
#include <stdint.h>

extern uint32_t data_from[], data_begin[], data_end[], bss_begin[], bss_end[], stack_top[];
int main(void);
void systick(void);
void uart(void);
void watchdog(void);
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

/* By number: the core's are below 16, the board's from there on. (GNU's range, as this file is for gcc alone.) */
__attribute__((section(".vectors"), used)) static void (*const vectors[])(void) = {[0] = (void (*)(void))stack_top,
                                                                                   [1] = start,
                                                                                   [2 ... 14] = stay,
                                                                                   [15] = systick,
                                                                                   [16 ... 20] = stay,
                                                                                   [21] = uart,
                                                                                   [22 ... 33] = stay,
                                                                                   [34] = watchdog};
