/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file log.h
 * One line an event on standard error: time, level, component, event, key=value.
 */
#ifndef MUSTER_CORE_LOG_H
#define MUSTER_CORE_LOG_H

enum mu_log_level { MU_LOG_ERROR, MU_LOG_WARNING, MU_LOG_INFO, MU_LOG_DEBUG };

/** Names the program in every line, and says from which level on to be silent. */
void mu_log_open(const char *component, enum mu_log_level most);

/** Writes one line; event is a word such as "agent-joined", format gives its key=value pairs. */
void mu_log(enum mu_log_level level, const char *event, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

#endif
