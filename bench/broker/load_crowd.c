/* SPDX-License-Identifier: Apache-2.0 */
/*
 * The receiving side: a0, a1, ..., a process each, which answer pings, give credit for floods, and
 * note on a board in shared memory when they have heard what was said to all.
 */
#include "core/clock.h"
#include "load.h"
#include "peer.h"

#include <fcntl.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

enum { CROWD_MAX = 200, TALES_MAX = 4096 };

/* What was said to all under one number. */
struct tale {
    _Atomic uint32_t heard;   /* by so many */
    _Atomic uint64_t last_ns; /* when the last of them heard it */
};

struct board {
    _Atomic uint32_t ready, faults;
    _Atomic uint64_t ready_ns; /* when the last of the crowd was ready */
    struct tale tales[TALES_MAX];
};

static struct board *board_open(const char *file)
{
    int fd = open(file, O_RDWR | O_CREAT | O_CLOEXEC, 0600);
    if (fd < 0 || ftruncate(fd, sizeof(struct board)) != 0) {
        load_die("cannot write %s", file);
    }
    void *at = mmap(NULL, sizeof(struct board), PROT_READ | PROT_WRITE, MAP_SHARED, fd, 0);
    close(fd);
    if (at == MAP_FAILED) {
        load_die("cannot map %s", file);
    }
    return at;
}

static void latest_note(_Atomic uint64_t *at)
{
    uint64_t now_ns = mu_clock_ns();
    uint64_t was_ns = atomic_load(at);
    while (was_ns < now_ns && !atomic_compare_exchange_weak(at, &was_ns, now_ns)) {
    }
}

/* --- one of the crowd ------------------------------------------------------------------------- */

static struct {
    struct board *board;
    char name[32];
    uint64_t tale, flood;
} one;

static void answer(const struct load_mail *mail, const char *word)
{
    char text[LOAD_BYTES + 1];
    load_write(text, word, mail->number, one.name);
    peer_answer(mail->from, text);
}

/* Every number must be one more than the last; 1 begins a new count. */
static void number_take(uint64_t *last, uint64_t number)
{
    if (number != *last + 1 && number != 1) {
        atomic_fetch_add(&one.board->faults, 1);
    }
    *last = number;
}

static void on_mail(const char *text)
{
    struct load_mail mail;
    load_read(&mail, text);
    if (strcmp(mail.word, "ping") == 0) {
        answer(&mail, "pong");
    } else if (strcmp(mail.word, "flood") == 0) {
        number_take(&one.flood, mail.number);
        if (mail.number % LOAD_CREDIT == 0) {
            answer(&mail, "credit");
        }
    } else if (strcmp(mail.word, "tale") == 0 && mail.number < TALES_MAX) {
        number_take(&one.tale, mail.number);
        latest_note(&one.board->tales[mail.number].last_ns);
        atomic_fetch_add(&one.board->tales[mail.number].heard, 1);
    }
}

static void one_live(const char *where, struct board *board, int index)
{
    prctl(PR_SET_PDEATHSIG, SIGTERM);
    one.board = board;
    snprintf(one.name, sizeof one.name, "a%d", index);
    struct peer_options options = {.where = where, .name = one.name, .on_mail = on_mail};
    peer_open(&options);
    latest_note(&board->ready_ns);
    atomic_fetch_add(&board->ready, 1);
    peer_serve();
    _exit(0); /* a crowd that leaves one by one keeps the broker busy for nothing */
}

/* crowd WHERE COUNT BOARD: says how long they took, and stays until it is ended. */
void load_crowd(char **words)
{
    static pid_t pids[CROWD_MAX];
    long count = strtol(words[1], NULL, 10);
    if (count < 1 || count > CROWD_MAX) {
        load_die("crowd: at most %d", CROWD_MAX);
    }
    struct board *board = board_open(words[2]);
    uint64_t began_ns = mu_clock_ns();
    for (int i = 0; i < count; i++) {
        pids[i] = fork();
        if (pids[i] == 0) {
            one_live(words[0], board, i);
        }
    }
    while (atomic_load(&board->ready) < (uint32_t)count && !load_is_over() &&
           mu_clock_ns() - began_ns < 30000000000u) {
        usleep(2000);
    }
    printf("{\"ready\": %u, \"ready_s\": %.4f}\n", atomic_load(&board->ready),
           (double)(atomic_load(&board->ready_ns) - began_ns) * 1e-9);
    fflush(stdout);
    while (!load_is_over()) {
        pause();
    }
    for (int i = 0; i < count; i++) {
        kill(pids[i], SIGTERM);
    }
    while (wait(NULL) > 0) {
    }
    exit(0);
}

/* --- telling all ------------------------------------------------------------------------------ */

struct telling {
    struct board *board;
    uint32_t crowd;
    uint64_t number; /* said last */
    uint64_t said_ns[TALES_MAX];
};

static bool is_heard(const struct telling *t, uint64_t number)
{
    return atomic_load(&t->board->tales[number].heard) >= t->crowd;
}

/* Says count tales, with so many under way. */
static void tales_tell(struct telling *t, uint64_t count, uint64_t window)
{
    uint64_t first = t->number + 1;
    for (uint64_t done = first; done < first + count;) {
        if (t->number + 1 < first + count && t->number + 1 < done + window) {
            char text[LOAD_BYTES + 1];
            load_write(text, "tale", ++t->number, load_me());
            t->said_ns[t->number] = mu_clock_ns();
            load_send("all", text, 0);
            continue;
        }
        peer_spin(1000000);
        while (done <= t->number && is_heard(t, done)) {
            done++;
        }
        if (mu_clock_ns() - t->said_ns[t->number] > 10000000000u) {
            load_die("tale %llu: %u of %u heard it", (unsigned long long)done,
                     atomic_load(&t->board->tales[done].heard), t->crowd);
        }
    }
}

/* tell WHERE CROWD BOARD: one broadcast at a time, then many under way. */
void load_tell(char **words)
{
    enum { WARM = 50, PACED = 500, STREAMED = 1000, WINDOW = 50 };
    static struct telling t;
    static uint64_t took_ns[PACED];
    t.board = board_open(words[2]);
    t.crowd = (uint32_t)strtoul(words[1], NULL, 10);
    struct peer_options options = {.where = words[0], .name = load_me()};
    peer_open(&options);
    tales_tell(&t, WARM, 1);
    load_cpu_begin();
    tales_tell(&t, PACED, 1);
    printf("{");
    load_cpu_print(PACED);
    for (uint64_t i = 0; i < PACED; i++) {
        uint64_t number = WARM + 1 + i;
        took_ns[i] = t.board->tales[number].last_ns - t.said_ns[number];
    }
    uint64_t first = t.number + 1;
    tales_tell(&t, STREAMED, WINDOW);
    uint64_t took_all_ns = t.board->tales[t.number].last_ns - t.said_ns[first];
    for (uint64_t i = 1; i <= t.number; i++) {
        if (t.board->tales[i].heard != t.crowd) {
            load_die("tale %llu was heard %u times", (unsigned long long)i,
                     t.board->tales[i].heard);
        }
    }
    if (t.board->faults > 0) {
        load_die("%u out of order", t.board->faults);
    }
    printf("\"p50_us\": %.1f, \"p99_us\": %.1f, \"deliveries_s\": %.0f}\n",
           load_quantile(took_ns, PACED, 0.5) * 1e-3, load_quantile(took_ns, PACED, 0.99) * 1e-3,
           (double)STREAMED * t.crowd * 1e9 / (double)took_all_ns);
}
