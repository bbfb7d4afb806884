/* SPDX-License-Identifier: Apache-2.0 */
#include "web/hands.h"

#include "core/clock.h"
#include "core/text.h"
#include "desk/world_words.h"

#include <stdio.h>
#include <string.h>

/* A run that makes no steps carries nothing out. */
static const uint64_t PATIENCE_NS = 10000000000;

/* Its orders are told from those of muster world by this name. */
static char source[] = "page";

/* So long a push lasts: long enough to be seen, simulated. */
static const double PUSH_S = 0.5;

mu_result hands_open(struct hands *h, struct bus *bus, struct viewers *viewers,
                     const struct watch *watch)
{
    *h = (struct hands){.viewers = viewers, .watch = watch};
    MU_TRY(bus_writer_open(bus, BUS_RUN_COMMAND, NULL, NULL, &h->commands));
    return bus_reader_open(bus, BUS_RUN_ANSWER, NULL, &h->answers);
}

/* --- orders ----------------------------------------------------------------------------------- */

static struct hands_ask *ask_find(struct hands *h, uint64_t seq)
{
    for (size_t i = 0; i < HANDS_ASKS_MAX; i++) {
        if (h->asks[i].seq == seq) {
            return &h->asks[i];
        }
    }
    return NULL;
}

static mu_result refuse(struct hands *h, mu_result why, const char *said)
{
    snprintf(h->said, sizeof h->said, "%s\n", said);
    return why;
}

/* @return how many words; more than HANDS_WORDS_MAX are counted as one more */
static size_t words_split(char *line, const char *words[HANDS_WORDS_MAX])
{
    size_t count = 0;
    char *rest = line;
    for (char *word; (word = strsep(&rest, " \t\r\n"));) {
        if (word[0] && count == HANDS_WORDS_MAX) {
            return count + 1;
        }
        if (word[0]) {
            words[count++] = word;
        }
    }
    return count;
}

/* The words stay in the line.  A file of the simulator's host is nothing for a page. */
static mu_result order_read(struct hands *h, char *line, muster_RunCommand *c)
{
    const char *words[HANDS_WORDS_MAX];
    char wrong[WORLD_WORDS_WRONG];
    size_t count = words_split(line, words);
    if (count > HANDS_WORDS_MAX || (count > 0 && strcmp(words[0], "save") == 0)) {
        return refuse(h, MU_FAULT_USAGE, "expected place, push, reset, sensor or pace");
    }
    mu_result read = world_words_read(words, count, PUSH_S, c, wrong);
    return read == MU_OK ? MU_OK : refuse(h, read, wrong);
}

static mu_result order_send(struct hands *h, muster_RunCommand *c, uint64_t viewer, uint64_t number)
{
    struct hands_ask *ask = ask_find(h, 0);
    if (!run_json_lives(&h->watch->run) || !h->watch->simulator[0]) {
        return refuse(h, MU_ABSENT, "no run lives");
    }
    if (!ask) {
        return refuse(h, MU_FULL, "too many orders wait for their answers");
    }
    c->simulator = (char *)(uintptr_t)h->watch->simulator; /* nobody writes there */
    c->source = source;
    c->seq = mu_clock_wall_ns(); /* higher than that of every order before */
    if (bus_write(&h->commands, c) != MU_OK) {
        return refuse(h, MU_BUSY, "the network does not keep up");
    }
    *ask = (struct hands_ask){c->seq, viewer, number, mu_clock_ns()};
    return MU_OK;
}

mu_result hands_do(struct hands *h, const char *line, uint64_t viewer, uint64_t number)
{
    char copy[HANDS_LINE_MAX + 1];
    muster_RunCommand c;
    if (strlen(line) > HANDS_LINE_MAX) {
        return refuse(h, MU_FAULT_USAGE, "no order is that long");
    }
    mu_text_copy(copy, sizeof copy, line);
    MU_TRY(order_read(h, copy, &c));
    return order_send(h, &c, viewer, number);
}

/* --- answers ---------------------------------------------------------------------------------- */

static void ask_end(struct hands *h, struct hands_ask *ask, bool good, int64_t step,
                    const char *text)
{
    struct viewer *to = viewers_find(h->viewers, ask->viewer);
    if (to) {
        struct mu_json *j = viewers_begin(h->viewers, "ordered");
        mu_json_object(j, NULL);
        mu_json_uint(j, "ask", ask->number);
        mu_json_bool(j, "good", good);
        mu_json_int(j, "step", step);
        mu_json_string(j, "text", text);
        mu_json_end(j);
        viewers_end(h->viewers);
        viewers_send(h->viewers, to);
    }
    ask->seq = 0;
}

static void answer_take(struct hands *h, const muster_RunAnswer *a)
{
    bool ours = strcmp(a->source, source) == 0 && a->seq > 0;
    struct hands_ask *ask = ours ? ask_find(h, a->seq) : NULL;
    if (ask) {
        ask_end(h, ask, a->result == muster_ORDER_DONE, a->step, a->reason);
    }
}

void hands_round(struct hands *h, uint64_t now_ns)
{
    enum bus_life life;
    const muster_RunAnswer *a;
    while ((a = bus_next(&h->answers, &life))) {
        if (life == BUS_DATA) {
            answer_take(h, a);
        }
    }
    for (size_t i = 0; i < HANDS_ASKS_MAX; i++) {
        struct hands_ask *ask = &h->asks[i];
        if (ask->seq && now_ns > ask->since_ns + PATIENCE_NS) {
            ask_end(h, ask, false, -1, "no answer: the run makes no steps");
        }
    }
}
