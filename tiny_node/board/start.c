/* Vectors and memory of a Cortex-M3 before main(). */
#include <stdint.h>

/* Of the linker; the size of what lies between two of them is a difference of addresses, not of pointers. */
extern uint32_t data_from[], data_begin[], data_end[], bss_begin[], bss_end[], stack_top[];
int main(void);
void systick(void);
void uart(void);
void watchdog(void);
void start(void);

static uintptr_t words(const uint32_t* begin, const uint32_t* end) { return ((uintptr_t)end - (uintptr_t)begin) / 4; }

void start(void) {
  for (uintptr_t i = words(data_begin, data_end); i-- > 0;) data_begin[i] = data_from[i];
  for (uintptr_t i = words(bss_begin, bss_end); i-- > 0;) bss_begin[i] = 0;
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
