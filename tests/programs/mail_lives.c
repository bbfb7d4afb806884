/* SPDX-License-Identifier: Apache-2.0 */
/*
 * A process whose agents leave, and come again under their names.
 *
 *   mail_lives DOMAIN again    thirty lives of red in one place: each is to be accepted
 *
 *   mail_lives DOMAIN words    forty lives of red, each with last words: the first words of the
 *                              next are to arrive
 *
 *   mail_lives DOMAIN crowd    says "ready"; at a line on its standard input thirty agents fill
 *                              their outboxes and leave: all of that is to arrive
 *
 *   mail_lives DOMAIN close    says something in on_state, when its process is closed
 *
 * The last line is "SO MANY of SO MANY".
 */
#include <muster/muster.h>

#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { CROWD = 30, PLACES = 64 };

static mu_process *process;
static mu_agent *red, *sink;
static unsigned welcomes, sunk, put;
static char content[MU_CONTENT_MAX + 1];

static void on_registered(void *self, mu_agent *a, bool accepted, const char *reason)
{
    (void)self;
    (void)a;
    (void)reason;
    welcomes += accepted;
}

static void on_mail(void *self, mu_agent *a, const struct mu_mail *mail)
{
    (void)self;
    sunk += a == sink && mail->content[0] == 'x';
}

static void say(mu_agent *from)
{
    struct mu_mail mail = {.dst = "sink", .content = content};
    while (mu_agent_send(from, &mail, NULL) == MU_OK) {
        put++;
        if (from == red) {
            return;
        }
    }
}

static void on_state(void *self, mu_agent *a, enum mu_state state)
{
    (void)self;
    if (state == MU_GONE) {
        say(a);
    }
}

static const struct mu_handlers handlers = {.on_registered = on_registered, .on_mail = on_mail};

static void agent_enter(mu_agent **a, const char *name, const struct mu_handlers *as)
{
    if (mu_agent_join(process, a, name, MU_KIND_AGENT, 0, as) != MU_OK) {
        fprintf(stderr, "%s cannot join\n", name);
        exit(3);
    }
}

static uint64_t now_ms(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (uint64_t)t.tv_sec * 1000u + (uint64_t)t.tv_nsec / 1000000u;
}

static void spin(void)
{
    if (mu_process_spin(process, 0) != MU_OK) {
        exit(4);
    }
}

/* @return whether it is as much within so many milliseconds */
static bool spin_until(const unsigned *count, unsigned wanted, uint64_t patience_ms)
{
    uint64_t until_ms = now_ms() + patience_ms;
    while (*count < wanted && now_ms() < until_ms) {
        if (mu_process_spin(process, 10000000) != MU_OK) {
            exit(4);
        }
    }
    return *count >= wanted;
}

static void again(void)
{
    unsigned lives = 0;
    for (int i = 0; i < 30; i++) {
        unsigned before = welcomes;
        agent_enter(&red, "red", &handlers);
        lives += spin_until(&welcomes, before + 1, 3000);
        mu_agent_set_state(red, MU_GONE);
        if (i % 2) {
            spin();
        }
    }
    printf("%u of 30\n", lives);
}

static void first_words(void)
{
    agent_enter(&sink, "sink", &handlers);
    agent_enter(&red, "red", &handlers);
    (void)spin_until(&welcomes, 2, 10000);
    for (int i = 0; i < 40; i++) {
        struct mu_mail last = {.dst = "nobody", .content = "last"};
        if (mu_agent_send(red, &last, NULL) != MU_OK) {
            exit(3);
        }
        mu_agent_set_state(red, MU_GONE);
        if (i % 2) {
            spin();
        }
        agent_enter(&red, "red", &handlers);
        say(red);
        (void)spin_until(&sunk, put, 2000);
    }
    printf("%u of %u\n", sunk, put);
}

static void crowd(void)
{
    static mu_agent *all[CROWD];
    agent_enter(&sink, "sink", &handlers);
    for (int i = 0; i < CROWD; i++) {
        char name[16];
        snprintf(name, sizeof name, "c%d", i);
        agent_enter(&all[i], name, &handlers);
    }
    (void)spin_until(&welcomes, CROWD + 1, 10000);
    puts("ready");
    fflush(stdout);
    (void)getchar();
    for (int i = 0; i < CROWD; i++) {
        say(all[i]);
        mu_agent_set_state(all[i], MU_GONE);
    }
    (void)spin_until(&sunk, put, 20000);
    printf("%u of %u\n", sunk, put);
}

/* The process closes with both in it: sink is not disposed of, and has the mail in its next life.
 */
static void close_with_a_word(struct mu_process_options *options)
{
    struct mu_handlers says = handlers;
    says.on_state = on_state;
    agent_enter(&sink, "sink", &handlers);
    agent_enter(&red, "red", &says);
    (void)spin_until(&welcomes, 2, 10000);
    mu_process_close(process);
    if (mu_process_open(&process, options) != MU_OK) {
        exit(4);
    }
    agent_enter(&sink, "sink", &handlers);
    (void)spin_until(&sunk, put, 10000);
    printf("%u of %u\n", sunk, put);
}

int main(int argc, char **argv)
{
    if (argc != 3) {
        return 2;
    }
    bool is_again = strcmp(argv[2], "again") == 0;
    struct mu_process_options options = {.domain = (int)strtol(argv[1], NULL, 10),
                                         .agents = is_again ? 1 : PLACES};
    memset(content, 'x', strcmp(argv[2], "crowd") == 0 ? MU_CONTENT_MAX : 1);
    if (mu_process_open(&process, &options) != MU_OK) {
        return 4;
    }
    if (is_again) {
        again();
    } else if (strcmp(argv[2], "words") == 0) {
        first_words();
    } else if (strcmp(argv[2], "crowd") == 0) {
        crowd();
    } else {
        close_with_a_word(&options);
    }
    mu_process_close(process);
    return 0;
}
