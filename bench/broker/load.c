/* SPDX-License-Identifier: Apache-2.0 */
/* The program, its words, and the loads of one pair. */
#include "load.h"

#include "core/clock.h"
#include "peer.h"

#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const uint64_t PATIENCE_NS = 10000000000;

/* Mails under way in a flood; the receiver gives credit for LOAD_CREDIT at a time, whichever broker
 * it is: MQTT tells a sender nothing of quality of service 0. */
enum { FLOOD_WINDOW = 1000 };

static volatile sig_atomic_t signal_came;

static void signal_note(int number)
{
    (void)number;
    signal_came = 1;
}

bool load_is_over(void)
{
    return signal_came;
}

void load_die(const char *format, ...)
{
    va_list args;
    va_start(args, format);
    fputs("bench: ", stderr);
    vfprintf(stderr, format, args);
    fputs("\n", stderr);
    va_end(args);
    exit(1);
}

const char *load_me(void)
{
    static char name[32];
    if (!name[0]) {
        snprintf(name, sizeof name, "sender%ld", (long)getpid());
    }
    return name;
}

/* Mails are written and read by hand: snprintf() and sscanf() would take a tenth of all the time
 * that a mail of a flood takes from sender to receiver. */
static char *number_write(char *at, uint64_t number)
{
    char digits[20];
    size_t count = 0;
    for (; number > 0 || count == 0; number /= 10) {
        digits[count++] = (char)('0' + number % 10);
    }
    while (count > 0) {
        *at++ = digits[--count];
    }
    return at;
}

void load_write(char text[LOAD_BYTES + 1], const char *word, uint64_t number, const char *from)
{
    char *at = stpcpy(text, word);
    *at++ = ' ';
    at = number_write(at, number);
    *at++ = ' ';
    at = stpcpy(at, from);
    *at++ = ' ';
    memset(at, 'x', (size_t)(text + LOAD_BYTES - at));
    text[LOAD_BYTES] = '\0';
}

/* A word of fewer than size bytes, and the space behind it.  @return what follows, or NULL */
static const char *word_read(char *word, size_t size, const char *text)
{
    const char *end = memccpy(word, text, ' ', size);
    if (!end || end - word == 1) {
        return NULL;
    }
    word[end - word - 1] = '\0';
    return text + (end - word);
}

void load_read(struct load_mail *mail, const char *text)
{
    const char *at = word_read(mail->word, sizeof mail->word, text);
    char *end = NULL;
    mail->number = at ? strtoull(at, &end, 10) : 0;
    if (!at || end == at || *end != ' ' || !word_read(mail->from, sizeof mail->from, end + 1)) {
        load_die("what is this: %s", text);
    }
}

void load_send(const char *to, const char *text, int level)
{
    uint64_t until_ns = 0;
    while (!peer_send(to, text, (enum mu_level)level)) {
        until_ns = until_ns ? until_ns : mu_clock_ns() + PATIENCE_NS;
        peer_spin(1000000);
        if (mu_clock_ns() > until_ns) {
            load_die("no room for a mail to %s", to);
        }
    }
}

void load_spin_on(void)
{
    while (!load_is_over()) {
        peer_spin(100000000);
    }
}

void load_await(const uint64_t *count, uint64_t wanted)
{
    uint64_t seen = *count;
    uint64_t until_ns = 0;
    while (*count < wanted) {
        peer_spin(10000000);
        if (*count != seen || until_ns == 0) {
            seen = *count;
            until_ns = mu_clock_ns() + PATIENCE_NS;
        }
        if (mu_clock_ns() > until_ns) {
            load_die("stuck at %llu of %llu", (unsigned long long)*count,
                     (unsigned long long)wanted);
        }
    }
}

static int compare(const void *a, const void *b)
{
    const uint64_t *x = a;
    const uint64_t *y = b;
    return (*x > *y) - (*x < *y);
}

double load_quantile(uint64_t *values, uint64_t count, double part)
{
    qsort(values, count, sizeof values[0], compare);
    uint64_t at = (uint64_t)(part * (double)count);
    return (double)values[at < count ? at : count - 1];
}

/* --- one pair --------------------------------------------------------------------------------- */

static uint64_t heard; /* the number of the last pong or credit */

static void on_answer(const char *text)
{
    struct load_mail mail;
    load_read(&mail, text);
    if (strcmp(mail.word, "pong") == 0 && mail.number != heard + 1) {
        load_die("pong %llu after %llu", (unsigned long long)mail.number,
                 (unsigned long long)heard);
    }
    heard = mail.number;
}

void load_sender_open(const char *where)
{
    struct peer_options options = {.where = where, .name = load_me(), .on_mail = on_answer};
    peer_open(&options);
}

void load_credit_await(uint64_t count)
{
    load_await(&heard, count);
}

uint64_t load_trip(const char *to, uint64_t number)
{
    char text[LOAD_BYTES + 1];
    load_write(text, "ping", number, load_me());
    uint64_t began_ns = mu_clock_ns();
    load_send(to, text, 0);
    load_await(&heard, number);
    return mu_clock_ns() - began_ns;
}

/* ping WHERE COUNT TARGETS: round trips, to the targets in turn. */
static void load_ping(char **words)
{
    enum { PINGS_MAX = 100000 };
    static uint64_t took_ns[PINGS_MAX];
    uint64_t count = strtoull(words[1], NULL, 10);
    uint64_t targets = strtoull(words[2], NULL, 10);
    if (count < 1 || count > PINGS_MAX || targets < 1) {
        load_die("ping: at most %d", PINGS_MAX);
    }
    load_sender_open(words[0]);
    const uint64_t warm = count / 20 + targets;
    for (uint64_t i = 1; i <= warm + count; i++) {
        char to[32];
        snprintf(to, sizeof to, "a%llu", (unsigned long long)(i % targets));
        if (i == warm + 1) {
            load_cpu_begin();
        }
        took_ns[i > warm ? i - warm - 1 : 0] = load_trip(to, i);
    }
    printf("{");
    load_cpu_print(count);
    printf("\"p50_us\": %.2f, \"p99_us\": %.2f}\n", load_quantile(took_ns, count, 0.5) * 1e-3,
           load_quantile(took_ns, count, 0.99) * 1e-3);
}

/* flood WHERE TO COUNT BATCH: a spin behind each BATCH mails; from the first mail to the receiver's
 * word that it has had the last. */
static void load_flood(char **words)
{
    uint64_t count = strtoull(words[2], NULL, 10);
    uint64_t batch = strtoull(words[3], NULL, 10);
    if (count < FLOOD_WINDOW || count > LOAD_COUNT_MAX || batch < 1) {
        load_die("flood: from %d to %d", FLOOD_WINDOW, LOAD_COUNT_MAX);
    }
    load_sender_open(words[0]);
    load_cpu_begin();
    uint64_t began_ns = mu_clock_ns();
    for (uint64_t sent = 0; sent < count && !load_is_over(); sent++) {
        char text[LOAD_BYTES + 1];
        load_write(text, "flood", sent + 1, load_me());
        if (sent >= FLOOD_WINDOW) {
            load_await(&heard, sent + 1 - FLOOD_WINDOW);
        }
        load_send(words[1], text, 0);
        if ((sent + 1) % batch == 0) {
            peer_spin(0);
        }
    }
    if (!load_is_over()) {
        load_await(&heard, count / LOAD_CREDIT * LOAD_CREDIT);
    }
    printf("{");
    load_cpu_print(count);
    printf("\"mails_s\": %.1f}\n", (double)count * 1e9 / (double)(mu_clock_ns() - began_ns));
}

/* --- the program ------------------------------------------------------------------------------ */

static const struct {
    const char *word;
    int words;
    void (*run)(char **words);
} loads[] = {
    {"crowd", 3, load_crowd}, {"ping", 3, load_ping},   {"flood", 4, load_flood},
    {"tell", 3, load_tell},   {"visit", 2, load_visit}, {"store", 4, load_store},
    {"drain", 3, load_drain}, {"pour", 3, load_pour},   {"deaf", 2, load_deaf},
    {"pace", 4, load_pace},   {"pairs", 3, load_pairs},
};

int main(int argc, char **argv)
{
    struct sigaction note = {.sa_handler = signal_note};
    sigaction(SIGINT, &note, NULL);
    sigaction(SIGTERM, &note, NULL);
    for (size_t i = 0; i < sizeof loads / sizeof loads[0]; i++) {
        if (argc == loads[i].words + 2 && strcmp(argv[1], loads[i].word) == 0) {
            loads[i].run(argv + 2);
            peer_close();
            return 0;
        }
    }
    fputs("bench: see bench/broker/run\n", stderr);
    return 2;
}
