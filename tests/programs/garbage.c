/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Says to a broker what no program of muster would say: names, groups, services, addresses and
 * contents that are none, too long, or in no encoding.
 *   garbage DOMAIN   (its broker is called main)
 * Prints a line for what comes back, "refused REASON", "receipt OUTCOME", "answer PERFORMATIVE
 * WORD", in order, until the answer to its last question has come; then ends with 0.
 */
#include "bus/bus.h"
#include "core/clock.h"
#include "wire.h"

#include <muster/limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { LONG = 10000 };

static const uint64_t PATIENCE_NS = 20000000000;

static char endless[LONG + 1];
static char largest[MU_CONTENT_MAX + 1], too_large[MU_CONTENT_MAX + 2];

static char *const bad_words[] = {
    (char[]){"two words"},
    (char[]){"a\"quote"},
    (char[]){"a\nline"},
    (char[]){"*"},
    (char[]){"\x1b[31m"},
    (char[]){"\xff\xfe"},
    (char[]){"\xc3"},
    (char[]){"a,b;c"},
    (char[]){"9lives"},
    (char[]){""},
    endless,
};
enum { BAD_WORDS = sizeof bad_words / sizeof bad_words[0] };

static char none[1], process[32], me[] = "garbler", clips[] = "x", hello[] = "hello";
static char receiver[] = "receiver", broker[] = "broker", last_question[] = "the last one";
static struct bus_writer registrations, ups;
static uint64_t seq;
static bool registered, done;

static void registration_write(char *name, char *host, char *entry)
{
    muster_Entry entries[] = {
        {.name = me, .state = muster_STATE_RUNNING, .home = none, .via = none, .host = none},
        {.name = entry, .state = muster_STATE_RUNNING, .home = none, .via = none, .host = none},
    };
    muster_Registration r = {
        .wire = muster_WIRE, .process = name, .broker = none, .host = host, .incarnation = 1};
    r.agents._buffer = entries;
    r.agents._length = r.agents._maximum = 2;
    mu_result written = bus_write(&registrations, &r);
    (void)written;
}

static muster_Mail mail_make(char *dst, char *content)
{
    return (muster_Mail){.src = me,
                         .seq = ++seq,
                         .dst = dst,
                         .layer = 3,
                         .performative = none,
                         .language = none,
                         .ontology = none,
                         .reply_with = none,
                         .in_reply_to = none,
                         .conversation = none,
                         .due_ns = -1,
                         .content = content};
}

static void mail_write(muster_Mail *m, char *as)
{
    muster_Act act = {
        .agent = as, .state = muster_STATE_RUNNING, .rules = none, .goal = none, .diary = none};
    act.mails._buffer = m;
    act.mails._length = act.mails._maximum = 1;
    muster_Up up = {.process = process, .step = muster_STEP_NOW};
    up.acts._buffer = &act;
    up.acts._length = up.acts._maximum = 1;
    mu_result written = bus_write(&ups, &up);
    (void)written;
}

static void question_write(const char *performative, char *content, char *reply_with)
{
    char copy[MU_FIELD_MAX + 1];
    snprintf(copy, sizeof copy, "%s", performative);
    muster_Mail m = mail_make(broker, content);
    m.layer = 2;
    m.performative = copy;
    m.reply_with = reply_with;
    mail_write(&m, me);
}

/* Each is a field of a mail that is good otherwise. */
static void mails_write(void)
{
    for (size_t i = 0; i < BAD_WORDS; i++) {
        muster_Mail m = mail_make(bad_words[i], hello);
        mail_write(&m, me);
        m = mail_make(receiver, hello);
        mail_write(&m, bad_words[i]);
        m = mail_make(receiver, hello);
        m.src = bad_words[i];
        mail_write(&m, me);
    }
    muster_Mail wrong[] = {mail_make(receiver, too_large), mail_make(receiver, hello),
                           mail_make(receiver, hello), mail_make(receiver, hello),
                           mail_make(receiver, hello)};
    wrong[1].priority = 2;
    wrong[2].seq = UINT64_MAX;
    wrong[3].seq = 0;
    wrong[4].performative = endless;
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        mail_write(&wrong[i], me);
    }
    muster_Mail odd[] = {mail_make(receiver, largest), mail_make(receiver, bad_words[5]),
                         mail_make(receiver, bad_words[4])};
    for (size_t i = 0; i < sizeof odd / sizeof odd[0]; i++) {
        odd[i].ontology = bad_words[5];
        mail_write(&odd[i], me);
    }
}

static void questions_write(void)
{
    static const char *const performatives[] = {
        "group-create", "group-join", "group-leave", "members",       "advertise", "withdraw",
        "find-service", "subscribe",  "lookup",      "no such thing", "\xff"};
    for (size_t p = 0; p < sizeof performatives / sizeof performatives[0]; p++) {
        for (size_t i = 0; i < BAD_WORDS; i++) {
            char content[LONG + 3];
            snprintf(content, sizeof content, "\"%s\"", bad_words[i]);
            question_write(performatives[p], content, clips);
        }
    }
    question_write("groups", none, last_question);
}

static void delivery_print(const muster_Delivery *d)
{
    static const char *const outcomes[] = {"delivered", "stored",    "expired", "box-full",
                                           "unknown",   "duplicate", "refused"};
    for (uint32_t i = 0; i < d->verdicts._length; i++) {
        const muster_Verdict *v = &d->verdicts._buffer[i];
        if (v->accepted) {
            seq = v->last_seq > seq ? v->last_seq : seq;
            registered = true;
        } else {
            printf("refused %s\n", v->reason);
        }
    }
    for (uint32_t i = 0; i < d->receipts._length; i++) {
        const muster_Receipt *r = &d->receipts._buffer[i];
        for (uint64_t n = r->first_seq; n <= r->last_seq; n++) {
            printf("receipt %s\n", r->result < 7 ? outcomes[r->result] : "another");
        }
    }
    for (uint32_t i = 0; i < d->parcels._length; i++) {
        const muster_Mail *m = &d->parcels._buffer[i].letter;
        printf("answer %s %.*s\n", m->performative, (int)strcspn(m->content, " \n"), m->content);
        done = done || strcmp(m->in_reply_to, last_question) == 0;
    }
}

/* Acknowledges all that has come, so that the broker goes on. */
static void deliveries_take(struct bus_reader *reader)
{
    enum bus_life life;
    const muster_Delivery *d;
    while ((d = bus_next(reader, &life))) {
        if (life == BUS_DATA) {
            delivery_print(d);
            muster_Ack ack = {.box = me};
            muster_Up up = {.process = process,
                            .broker_incarnation = d->broker_incarnation,
                            .step = muster_STEP_NOW};
            if (d->parcels._length > 0) {
                ack.number = d->parcels._buffer[d->parcels._length - 1].number;
                up.acks._buffer = &ack;
                up.acks._length = up.acks._maximum = 1;
                mu_result written = bus_write(&ups, &up);
                (void)written;
            }
        }
    }
}

int main(int argc, char **argv)
{
    static struct bus bus;
    static struct bus_reader reader;
    struct bus_options options = {.domain = argc == 2 ? (int)strtol(argv[1], NULL, 10) : -1,
                                  .place = BUS_AGENT,
                                  .name = "garbage"};
    memset(endless, 'n', LONG);
    memset(largest, 'x', MU_CONTENT_MAX);
    memset(too_large, 'x', MU_CONTENT_MAX + 1);
    snprintf(process, sizeof process, "p-garbage.%ld", (long)getpid());
    if (options.domain < 0 || bus_open(&bus, &options) != MU_OK ||
        bus_writer_open(&bus, BUS_REGISTRATION, NULL, NULL, &registrations) != MU_OK ||
        bus_writer_open(&bus, BUS_UP, "broker.main", NULL, &ups) != MU_OK ||
        bus_reader_open(&bus, BUS_DELIVERY, process, &reader) != MU_OK) {
        return 4;
    }
    uint64_t until_ns = mu_clock_ns() + PATIENCE_NS;
    registration_write(process, hello, me);
    while (bus_reader_matches(&reader) == 0 || bus_writer_matches(&ups) == 0) {
        if (mu_clock_ns() > until_ns) {
            return 4;
        }
        bus_wait(&bus, 0, 10000000);
    }
    for (size_t i = 0; i < BAD_WORDS; i++) {
        registration_write(process, bad_words[i], bad_words[i]);
        registration_write(bad_words[i], hello, clips);
        for (uint64_t wait_ns = mu_clock_ns() + 50000000; mu_clock_ns() < wait_ns;) {
            bus_wait(&bus, 0, 10000000); /* of what is not read yet the last word alone stays */
            deliveries_take(&reader);
        }
    }
    while (!registered && mu_clock_ns() < until_ns) {
        bus_wait(&bus, 0, 10000000);
        deliveries_take(&reader);
    }
    mails_write();
    questions_write();
    while (!done && mu_clock_ns() < until_ns) {
        bus_wait(&bus, 0, 10000000);
        deliveries_take(&reader);
    }
    bus_close(&bus);
    return done ? 0 : 1;
}
