/* SPDX-License-Identifier: Apache-2.0 */
#include "web/web.h"

#include "core/clock.h"
#include "core/text.h"
#include "operator/operator.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A run that makes no steps carries nothing out. */
static const uint64_t PATIENCE_NS = 10000000000;

/* An answer may come a little behind the end of its run. */
static const uint64_t LAST_ANSWER_NS = 500000000;

static const double AT_MAX_S = 1e9;

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

static mu_result at_read(struct hands *h, const char *word, muster_RunCommand *c)
{
    char *end;
    double at_s = strtod(word, &end);
    if (end == word || *end || !(at_s >= 0 && at_s <= AT_MAX_S)) {
        return refuse(h, MU_FAULT_USAGE, "at: expected seconds of the run, from 0 on");
    }
    c->due_ns = (uint64_t)llround(at_s * 1e9);
    return MU_OK;
}

/* Whether it is one the simulator finds out, which knows the bodies. */
static mu_result when_read(struct hands *h, char *condition, muster_RunCommand *c)
{
    if (strlen(condition) > MU_CONDITION_MAX) {
        return refuse(h, MU_FAULT_USAGE, "when: no condition is that long");
    }
    c->when = condition;
    return MU_OK;
}

/* The lines behind the order. */
static mu_result later_read(struct hands *h, char *lines, muster_RunCommand *c)
{
    for (char *line; (line = strsep(&lines, "\n"));) {
        if (strncmp(line, "at ", 3) == 0) {
            MU_TRY(at_read(h, line + 3, c));
        } else if (strncmp(line, "when ", 5) == 0) {
            MU_TRY(when_read(h, line + 5, c));
        } else if (line[0]) {
            return refuse(h, MU_FAULT_USAGE, "expected at SECONDS or when CONDITION in a line");
        }
    }
    return MU_OK;
}

static bool is_for_later(const struct hands_ask *ask)
{
    return ask->due_ns > 0 || ask->when[0];
}

/* @return a place for an order; NULL: there is none */
static struct hands_ask *place_find(struct hands *h, const muster_RunCommand *c)
{
    size_t later = 0;
    for (size_t i = 0; i < HANDS_ASKS_MAX; i++) {
        later += h->asks[i].seq && is_for_later(&h->asks[i]);
    }
    bool fits = (c->due_ns == 0 && !c->when[0]) || later < HANDS_LATER_MAX;
    return fits ? ask_find(h, 0) : NULL;
}

static mu_result order_send(struct hands *h, muster_RunCommand *c)
{
    if (!run_json_lives(&h->watch->run) || !h->watch->simulator[0]) {
        return refuse(h, MU_ABSENT, "no run lives");
    }
    if (!place_find(h, c)) {
        return refuse(h, MU_FULL, "too many orders wait for their answers");
    }
    c->simulator = (char *)(uintptr_t)h->watch->simulator; /* there is no writer */
    c->source = source;
    c->seq = mu_clock_wall_ns(); /* higher than that of every order before */
    if (bus_write(&h->commands, c) != MU_OK) {
        return refuse(h, MU_BUSY, "the network does not keep up");
    }
    return MU_OK;
}

/* Keeps what there is to tell of an order that is out, but the page that has asked. */
static struct hands_ask *ask_put(struct hands *h, const muster_RunCommand *c, const char *line)
{
    struct hands_ask *ask = place_find(h, c);
    *ask = (struct hands_ask){.seq = c->seq, .due_ns = c->due_ns};
    mu_text_copy(ask->simulator, sizeof ask->simulator, c->simulator);
    mu_text_copy(ask->line, sizeof ask->line, line);
    mu_text_copy(ask->when, sizeof ask->when, c->when);
    ask->until_ns = is_for_later(ask) ? UINT64_MAX : mu_clock_ns() + PATIENCE_NS;
    h->changed = h->changed || is_for_later(ask);
    return ask;
}

mu_result hands_do(struct hands *h, const char *text, uint64_t viewer, uint64_t number)
{
    char copy[HANDS_TEXT_MAX + 1], line[HANDS_LINE_MAX + 1];
    muster_RunCommand c;
    if (strcspn(text, "\n") > HANDS_LINE_MAX || strlen(text) > HANDS_TEXT_MAX) {
        return refuse(h, MU_FAULT_USAGE, "no order is that long");
    }
    mu_text_copy(copy, sizeof copy, text);
    char *behind = copy, *order = strsep(&behind, "\n");
    mu_text_copy(line, sizeof line, order);
    MU_TRY(order_read(h, order, &c));
    MU_TRY(later_read(h, behind, &c));
    mu_result sent = order_send(h, &c);
    if (sent == MU_OK) {
        struct hands_ask *ask = ask_put(h, &c, line);
        ask->viewer = viewer;
        ask->number = number;
    }
    return sent;
}

/* --- answers ---------------------------------------------------------------------------------- */

/* What became of an order. */
struct hands_end {
    bool good;
    int64_t step;
    const char *text; /* why not */
};

/* Fills in what was ordered, and for when. */
static void order_write(struct mu_json *j, const struct hands_ask *ask)
{
    mu_json_string(j, "order", ask->line);
    mu_json_real(j, "at_s", (double)ask->due_ns / 1e9);
    mu_json_string(j, "when", ask->when);
}

static void end_tell(struct hands *h, const struct hands_ask *ask, struct viewer *to,
                     const struct hands_end *end)
{
    struct mu_json *j = viewers_begin(h->viewers, "ordered");
    mu_json_object(j, NULL);
    mu_json_uint(j, "ask", to->id == ask->viewer ? ask->number : 0);
    mu_json_bool(j, "good", end->good);
    mu_json_int(j, "step", end->step);
    mu_json_string(j, "text", end->text);
    order_write(j, ask);
    mu_json_end(j);
    viewers_end(h->viewers);
    viewers_send(h->viewers, to);
}

/* All pages see what it does to the world, and the page that asked may be another viewer by now. */
static void ask_end(struct hands *h, struct hands_ask *ask, const struct hands_end *end)
{
    for (size_t i = 0; i < VIEWERS_MAX; i++) {
        if (h->viewers->all[i].used) {
            end_tell(h, ask, &h->viewers->all[i], end);
        }
    }
    h->changed = h->changed || is_for_later(ask);
    ask->seq = 0;
}

static void answer_take(struct hands *h, const muster_RunAnswer *a)
{
    bool ours = strcmp(a->source, source) == 0 && a->seq > 0;
    struct hands_ask *ask = ours ? ask_find(h, a->seq) : NULL;
    if (ask) {
        ask_end(h, ask, &(struct hands_end){a->result == muster_ORDER_DONE, a->step, a->reason});
    }
}

static bool is_over(const struct hands *h, const struct hands_ask *ask)
{
    return !run_json_lives(&h->watch->run) || strcmp(ask->simulator, h->watch->simulator) != 0;
}

static void ask_review(struct hands *h, struct hands_ask *ask, uint64_t now_ns)
{
    bool over = is_over(h, ask);
    if (over && ask->until_ns > now_ns + LAST_ANSWER_NS) {
        ask->until_ns = now_ns + LAST_ANSWER_NS;
    }
    if (now_ns > ask->until_ns) {
        ask_end(h, ask,
                &(struct hands_end){.step = -1,
                                    .text = over ? "the run has ended"
                                                 : "no answer: the run makes no steps"});
    }
}

/* --- what waits ------------------------------------------------------------------------------- */

static void later_show(struct hands *h)
{
    struct mu_json *j = board_begin(h->watch->board, BOARD_LATER);
    mu_json_object(j, NULL);
    mu_json_list(j, "orders");
    for (size_t i = 0; i < HANDS_ASKS_MAX; i++) {
        if (h->asks[i].seq && is_for_later(&h->asks[i])) {
            mu_json_object(j, NULL);
            order_write(j, &h->asks[i]);
            mu_json_end(j);
        }
    }
    mu_json_end(j);
    mu_json_end(j);
    (void)board_end(h->watch->board);
    h->changed = false;
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
        if (h->asks[i].seq) {
            ask_review(h, &h->asks[i], now_ns);
        }
    }
    if (h->changed) {
        later_show(h);
    }
}
