/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file signals.h
 * SIGINT and SIGTERM ask a program to end: its loop looks whether one has come.
 */
#ifndef MUSTER_CORE_SIGNALS_H
#define MUSTER_CORE_SIGNALS_H

#include <signal.h>

/* The signal that came last; 0: none. */
extern volatile sig_atomic_t mu_signal_came;

/** From now on a signal is noted and ends nothing by itself. */
void mu_signals_note(void);

#endif
