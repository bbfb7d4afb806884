/* SPDX-License-Identifier: Apache-2.0 */
#include "history.h"

#include "core/random.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { NOTES = 48, NOTE_BYTES = 160, QUIET_ROUNDS = 4000 };

#define PATIENCE_NS (100000 * MS) /* who is not done by then never will be */

struct history history;

static struct mu_random dice;
static char notes[NOTES][NOTE_BYTES];
static uint32_t notes_count;

uint32_t history_roll(uint32_t sides)
{
    return (uint32_t)mu_random_between(&dice, 0, (int64_t)sides - 1);
}

bool history_chance(uint32_t one_in)
{
    return history_roll(one_in) == 0;
}

const char *history_name(int index)
{
    static char names_text[NAMES][4];
    snprintf(names_text[index], sizeof names_text[index], "n%c", 'a' + index);
    return names_text[index];
}

int history_name_index(const char *name)
{
    return name[0] == 'n' && name[1] >= 'a' && name[1] < 'a' + NAMES && !name[2] ? name[1] - 'a'
                                                                                 : NOBODY;
}

void history_note(const char *format, ...)
{
    va_list args;
    va_start(args, format);
    char *line = notes[notes_count++ % NOTES];
    int head = snprintf(line, NOTE_BYTES, "%llu ms: ", (unsigned long long)(history.now_ns / MS));
    vsnprintf(line + head, NOTE_BYTES - (size_t)head, format, args);
    va_end(args);
    if (getenv("MUSTER_TELL")) {
        fprintf(stderr, "    %s\n", line);
    }
}

_Noreturn void history_fail(const char *what, const char *file, int line)
{
    printf("\n  seed %llu: %s:%d: does not hold: %s\n  what happened last:\n",
           (unsigned long long)history.seed, file, line, what);
    for (uint32_t i = notes_count > NOTES ? notes_count - NOTES : 0; i < notes_count; i++) {
        printf("    %s\n", notes[i % NOTES]);
    }
    fflush(stdout);
    _Exit(EXIT_FAILURE);
}

/* --- steps ------------------------------------------------------------------------------------ */

static void processes_live(void)
{
    for (int i = 0; i < PROCESSES; i++) {
        struct history_process *p = &history.processes[i];
        if (!p->alive) {
            continue;
        }
        process_beat(p);
        while (!history_chance(3) && inbox_take(p)) {
        }
        if (!history_chance(3)) {
            process_flush(p);
        }
    }
}

/* One turn of everything, in an order that the dice choose; time has passed before. */
static void turn(uint64_t passed_ns)
{
    history.now_ns += passed_ns;
    uint32_t first = history_roll(PROCESSES);
    for (uint32_t i = 0; i < PROCESSES && history.life.b; i++) {
        struct history_process *p = &history.processes[(first + i) % PROCESSES];
        if (p->alive && p->reaches && p->registration_due && !history_chance(4)) {
            net_register(p);
        }
        while (p->reaches && p->ups_count > 0 && !history_chance(4)) {
            net_feed(p);
        }
    }
    if (history.life.b) {
        net_match();
        life_round();
        life_check();
    }
    processes_live();
}

static void step(void)
{
    static const uint64_t passes_ms[] = {0, 0, 1, 1, 2, 5, 20, 100};
    acts_one();
    if (!history_chance(4)) {
        turn(passes_ms[history_roll(8)] * MS);
    }
}

/* --- the end ---------------------------------------------------------------------------------- */

/* Everybody is back: each name that was ever given away has an agent that runs. */
static void all_come_back(void)
{
    if (!history.life.b) {
        life_begin();
    }
    history.life.disk_fails = false;
    for (int i = 0; i < PROCESSES; i++) {
        struct history_process *p = &history.processes[i];
        if (!p->alive) {
            process_begin(p);
        }
        p->reaches = true;
        p->registration_due = true;
        for (int seat = 0; seat < SEATS; seat++) {
            struct actor *a = &p->seats[seat];
            if (a->name != NOBODY && a->state == muster_STATE_SUSPENDED) {
                a->state = muster_STATE_RUNNING;
            }
        }
    }
}

static bool name_is_borne(int name)
{
    for (int i = 0; i < PROCESSES * SEATS; i++) {
        const struct actor *a = &history.processes[i / SEATS].seats[i % SEATS];
        if (a->name == name && !a->refused && !a->leaving) {
            return true;
        }
    }
    return false;
}

static void missing_join(void)
{
    for (int name = 0; name < NAMES; name++) {
        muster_Member m;
        if (!life_member(name, &m) || m.state != muster_STATE_ABSENT || name_is_borne(name)) {
            continue;
        }
        for (int i = 0; i < PROCESSES * SEATS; i++) {
            struct history_process *p = &history.processes[i / SEATS];
            struct actor *a = &p->seats[i % SEATS];
            if (a->name == NOBODY || a->refused) {
                a->name = NOBODY;
                agent_join(p, i % SEATS, name);
                break;
            }
        }
    }
}

static bool agent_is_done(const struct actor *a)
{
    return a->name == NOBODY || a->refused ||
           (a->registered && a->waiting == 0 && a->acked_number == a->last_number);
}

static bool all_is_done(void)
{
    bool done = life_status().waiting == 0;
    for (int i = 0; i < PROCESSES; i++) {
        const struct history_process *p = &history.processes[i];
        done = done && p->ups_count == 0 && p->deliveries_count == 0;
        for (int seat = 0; seat < SEATS; seat++) {
            bool is_done = agent_is_done(&p->seats[seat]);
            if (!is_done && history.now_ns > PATIENCE_NS) {
                const struct actor *a = &p->seats[seat];
                history_note("%s in %s: registered %d, %lu mails from %llu, taken %llu, acked %llu",
                             history_name(a->name), p->name, a->registered,
                             (unsigned long)a->waiting, (unsigned long long)a->first_seq,
                             (unsigned long long)a->last_number,
                             (unsigned long long)a->acked_number);
            }
            done = done && is_done;
        }
    }
    return done;
}

/* A name has one holder: the process that the white pages name, and no other believes it. */
static void check_holders(void)
{
    for (int name = 0; name < NAMES; name++) {
        muster_Member m = {.process = words("")};
        bool known = life_member(name, &m);
        uint32_t holders = 0;
        for (int i = 0; i < PROCESSES; i++) {
            struct history_process *p = &history.processes[i];
            struct actor *a = process_agent(p, name);
            if (a && a->registered && !a->leaving) {
                holders++;
                HOLD(known && strcmp(m.process, p->name) == 0);
                HOLD(m.state == a->state);
            }
        }
        history_note("%s is in %s, state %d, with %lu holders", history_name(name),
                     known ? m.process : "-", known ? (int)m.state : 0, (unsigned long)holders);
        HOLD(holders <= 1);
        HOLD(holders == 1 || !known || m.state == muster_STATE_ABSENT);
    }
}

static void grow_quiet(void)
{
    history_note("all come back, and it grows quiet");
    history.is_quiet = true;
    uint32_t done_for = 0;
    for (uint32_t i = 0; i < QUIET_ROUNDS && done_for < 40; i++) {
        all_come_back();
        missing_join();
        turn((i % 8 == 0 ? 400 : 5) * MS);
        done_for = all_is_done() ? done_for + 1 : 0;
    }
    muster_BrokerStatus s = life_status();
    history_note("waiting %llu, stored %lu", (unsigned long long)s.waiting,
                 (unsigned long)s.stored);
    HOLD(all_is_done());
    check_holders();
    ledger_check_end();
    book_check_copies();
    life_check_empty();
}

void history_live(uint64_t seed, uint32_t steps)
{
    static const muster_BoxPolicy policies[] = {muster_BOX_REFUSE_NEW, muster_BOX_REFUSE_NEW,
                                                muster_BOX_DROP_OLDEST, muster_BOX_DROP_LOWEST};
    mu_random_seed(&dice, seed, "history");
    history.seed = seed;
    history.now_ns = 1000 * MS;
    history.has_store = !history_chance(4);
    history.loses = history_chance(2);
    history.box_mails = history_chance(3) ? 4 + history_roll(12) : 0;
    history.box_policy = policies[history_roll(4)];
    for (int i = 0; i < PROCESSES; i++) {
        struct history_process *p = &history.processes[i];
        snprintf(p->name, sizeof p->name, "p%d", i);
        for (int seat = 0; seat < SEATS; seat++) {
            p->seats[seat].name = NOBODY;
        }
    }
    history_note("%s store, %s, boxes of %lu", history.has_store ? "a" : "no",
                 history.loses ? "losses" : "no losses", (unsigned long)history.box_mails);
    disk_clear();
    life_begin();
    for (uint32_t i = 0; i < steps && history.mails + SEATS * PROCESSES < MAILS; i++) {
        step();
    }
    grow_quiet();
}
