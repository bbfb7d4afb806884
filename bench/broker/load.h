/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file load.h
 * The loads: what is done to a broker, and the clock beside it.
 *
 * The same code for every broker, above peer.h.  Each prints one JSON object.  A mail is LOAD_BYTES
 * of text: a word, a number, the sender's name, and filling.
 */
#ifndef BENCH_BROKER_LOAD_H
#define BENCH_BROKER_LOAD_H

#include <stdbool.h>
#include <stdint.h>
#include <sys/types.h>

enum { LOAD_BYTES = 128, LOAD_CREDIT = 100, LOAD_COUNT_MAX = 10000000 };

/* A mail, read. */
struct load_mail {
    char word[16], from[32];
    uint64_t number;
};

void load_die(const char *format, ...) __attribute__((format(printf, 1, 2), noreturn));

/** SIGTERM or SIGINT has come. */
bool load_is_over(void);

void load_write(char text[LOAD_BYTES + 1], const char *word, uint64_t number, const char *from);
void load_read(struct load_mail *mail, const char *text);

/** Sends, and spins while nothing fits. */
void load_send(const char *to, const char *text, int level);

/** Spins until the program is told to end. */
void load_spin_on(void);

/** Spins until *count is at least wanted; ends the program after ten seconds without progress. */
void load_await(const uint64_t *count, uint64_t wanted);

/** @return the value below which this part of the sorted values lies, 0.5: the median */
double load_quantile(uint64_t *values, uint64_t count, double part);

/** @return the name of this process as a sender */
const char *load_me(void);

/** Connects as a sender that hears answers. */
void load_sender_open(const char *where);

/** Waits until the receiver has given credit for so many mails, a multiple of LOAD_CREDIT. */
void load_credit_await(uint64_t count);

/** @return how long ping number took, in ns; the numbers of a sender are 1, 2, ... */
uint64_t load_trip(const char *to, uint64_t number);

/* load_cpu.c */

/** One more process whose processor time counts; before load_cpu_begin(). */
void load_cpu_watch(pid_t pid);
void load_cpu_begin(void);

/** Prints two members of the JSON object, in us a unit, if LOAD_WATCH names a broker. */
void load_cpu_print(uint64_t units);

/* load_steady.c */
void load_pace(char **words);
void load_pairs(char **words);

/* load_crowd.c */
void load_crowd(char **words);
void load_tell(char **words);

/* load_box.c */
void load_visit(char **words);
void load_store(char **words);
void load_drain(char **words);
void load_pour(char **words);
void load_deaf(char **words);

#endif
