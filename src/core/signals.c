/* SPDX-License-Identifier: Apache-2.0 */
#include "core/signals.h"

#include <stddef.h>

volatile sig_atomic_t mu_signal_came;

static void signal_note(int number)
{
    mu_signal_came = number;
}

void mu_signals_note(void)
{
    struct sigaction note = {.sa_handler = signal_note};
    sigaction(SIGINT, &note, NULL);
    sigaction(SIGTERM, &note, NULL);
}
