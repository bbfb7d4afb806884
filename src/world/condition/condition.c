/* SPDX-License-Identifier: Apache-2.0 */
#include "world/condition/condition.h"

#include "core/text.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { CONDITION_WORDS = 6 };

static const struct {
    const char *name;
    size_t offset;
} condition_numbers[] = {
    {"x_m", offsetof(struct condition_numbers, x_m)},
    {"y_m", offsetof(struct condition_numbers, y_m)},
    {"heading_rad", offsetof(struct condition_numbers, heading_rad)},
    {"distance_m", offsetof(struct condition_numbers, distance_m)},
    {"stalls", offsetof(struct condition_numbers, stalls)},
    {"stalled_s", offsetof(struct condition_numbers, stalled_s)},
    {"mail_sent", offsetof(struct condition_numbers, mail_sent)},
    {"mail_received", offsetof(struct condition_numbers, mail_received)},
    {"rule_firings", offsetof(struct condition_numbers, rule_firings)},
};

enum { NUMBERS = sizeof condition_numbers / sizeof condition_numbers[0] };

/* A condition while it is read. */
struct reading {
    struct condition *c;
    const struct condition_names *names;
    char words[CONDITION_WORDS + 1][CONDITION_WORD_MAX];
    size_t count;
    char *why;
};

static mu_result expected(struct reading *r, const char *what)
{
    snprintf(r->why, CONDITION_WHY_MAX, "expected %s", what);
    return MU_MALFORMED;
}

static mu_result words_split(struct reading *r, const char *text)
{
    for (const char *at = text; *(at += strspn(at, " ")); at += strcspn(at, " ")) {
        size_t len = strcspn(at, " ");
        if (r->count == CONDITION_WORDS + 1 || len >= CONDITION_WORD_MAX) {
            return expected(r, "a shorter condition");
        }
        memcpy(r->words[r->count], at, len);
        r->words[r->count++][len] = '\0';
    }
    return MU_OK;
}

static mu_result number_read(struct reading *r, size_t word, double *out)
{
    char *end = r->words[word];
    *out = word < r->count ? strtod(r->words[word], &end) : 0;
    if (end == r->words[word] || *end || !isfinite(*out)) {
        snprintf(r->why, CONDITION_WHY_MAX, "expected a number%s%s",
                 word < r->count ? ", not " : "", word < r->count ? r->words[word] : " at the end");
        return MU_MALFORMED;
    }
    return MU_OK;
}

static mu_result distance_read(struct reading *r, size_t word, double *out)
{
    mu_result read = number_read(r, word, out);
    return read == MU_OK && *out <= 0 ? expected(r, "a distance of more than 0 m") : read;
}

static mu_result body_read(struct reading *r, const char *name, bool robot, int *out)
{
    *out = r->names->find(r->names->self, name);
    if (*out < 0 || (robot && *out >= r->names->robots)) {
        snprintf(r->why, CONDITION_WHY_MAX, "no %s '%s' in this experiment",
                 robot ? "robot" : "robot or thing", name);
        return MU_MALFORMED;
    }
    return MU_OK;
}

/* An agent with or without a body. */
static mu_result mind_read(struct reading *r, const char *name, int *out)
{
    int agent = r->names->find_agent ? r->names->find_agent(r->names->agents, name) : -1;
    *out = agent >= 0 ? CONDITION_AGENTS + agent : 0;
    return agent >= 0 ? MU_OK : body_read(r, name, true, out);
}

/* --- NAME.NUMBER > VALUE ---------------------------------------------------------------------- */

static mu_result compare_read(struct reading *r)
{
    static const char *const signs[] = {[CONDITION_ABOVE] = ">",
                                        [CONDITION_NOT_BELOW] = ">=",
                                        [CONDITION_BELOW] = "<",
                                        [CONDITION_NOT_ABOVE] = "<="};
    for (unsigned i = 0; r->count == 3 && i < sizeof signs / sizeof signs[0]; i++) {
        if (strcmp(r->words[1], signs[i]) == 0) {
            r->c->compare = (enum condition_compare)i;
            return number_read(r, 2, &r->c->value);
        }
    }
    return expected(r, "> >= < or <= and a number, each between blanks");
}

static mu_result number_name_read(struct reading *r, const char *name)
{
    for (size_t i = 0; i < NUMBERS; i++) {
        if (strcmp(condition_numbers[i].name, name) == 0) {
            r->c->number = condition_numbers[i].offset;
            return compare_read(r);
        }
    }
    struct mu_text why = mu_text_in(r->why, CONDITION_WHY_MAX);
    mu_text_add(&why, "expected one of");
    for (size_t i = 0; i < NUMBERS; i++) {
        mu_text_format(&why, " %s", condition_numbers[i].name);
    }
    mu_text_format(&why, ", not '%s'", name);
    return MU_MALFORMED;
}

/* Names may have dots, numbers have none. */
static mu_result statistic_read(struct reading *r)
{
    char name[CONDITION_WORD_MAX];
    const char *dot = strrchr(r->words[0], '.');
    r->c->kind = CONDITION_NUMBER;
    snprintf(name, sizeof name, "%.*s", (int)(dot - r->words[0]), r->words[0]);
    if (strcmp(name, "robots") == 0) {
        r->c->body = CONDITION_ALL_ROBOTS;
    } else {
        mu_result found = body_read(r, name, true, &r->c->body);
        if (found != MU_OK) {
            return found;
        }
    }
    return number_name_read(r, dot + 1);
}

/* --- NAME [not] WORD ... ---------------------------------------------------------------------- */

static mu_result near_read(struct reading *r, size_t at)
{
    if (r->count != at + 2) {
        return expected(r, "NAME near NAME METRES");
    }
    mu_result read = body_read(r, r->words[at], false, &r->c->other);
    return read == MU_OK ? distance_read(r, at + 1, &r->c->value) : read;
}

static mu_result at_read(struct reading *r, size_t at)
{
    if (r->count != at + 3) {
        return expected(r, "NAME at X Y METRES");
    }
    mu_result read = number_read(r, at, &r->c->x_m);
    read = read == MU_OK ? number_read(r, at + 1, &r->c->y_m) : read;
    return read == MU_OK ? distance_read(r, at + 2, &r->c->value) : read;
}

static mu_result stalled_read(struct reading *r, size_t at)
{
    return r->count == at ? MU_OK : expected(r, "nothing behind stalled");
}

static mu_result told_read(struct reading *r, size_t at)
{
    bool to = r->count == at + 3 && strcmp(r->words[at + 1], "to") == 0;
    if (r->count != at + 1 && !to) {
        return expected(r, "NAME told WORD, or NAME told WORD to RECEIVER");
    }
    mu_text_copy(r->c->word, sizeof r->c->word, r->words[at]);
    mu_text_copy(r->c->to, sizeof r->c->to, to ? r->words[at + 2] : "");
    return MU_OK;
}

static mu_result fired_read(struct reading *r, size_t at)
{
    if (r->count != at + 1) {
        return expected(r, "NAME fired RULE");
    }
    mu_text_copy(r->c->word, sizeof r->c->word, r->words[at]);
    return MU_OK;
}

/* What a condition may be of. */
enum subject { OF_THINGS, OF_ROBOTS, OF_MINDS };

static const struct {
    const char *word;
    enum condition_kind kind;
    enum subject of;
    mu_result (*read)(struct reading *r, size_t at);
} condition_verbs[] = {
    {"near", CONDITION_NEAR, OF_THINGS, near_read},
    {"at", CONDITION_AT, OF_THINGS, at_read},
    {"stalled", CONDITION_STALLED, OF_ROBOTS, stalled_read},
    {"told", CONDITION_TOLD, OF_MINDS, told_read},
    {"fired", CONDITION_FIRED, OF_MINDS, fired_read},
};

static mu_result verb_read(struct reading *r)
{
    r->c->negated = r->count > 1 && strcmp(r->words[1], "not") == 0;
    size_t at = r->c->negated ? 2 : 1;
    for (size_t i = 0; i < sizeof condition_verbs / sizeof condition_verbs[0]; i++) {
        if (at < r->count && strcmp(r->words[at], condition_verbs[i].word) == 0) {
            r->c->kind = condition_verbs[i].kind;
            mu_result found =
                condition_verbs[i].of == OF_MINDS
                    ? mind_read(r, r->words[0], &r->c->body)
                    : body_read(r, r->words[0], condition_verbs[i].of == OF_ROBOTS, &r->c->body);
            return found == MU_OK ? condition_verbs[i].read(r, at + 1) : found;
        }
    }
    return expected(r, "near, at, stalled, told or fired behind a name, or NAME.NUMBER > VALUE, "
                       "or time > S");
}

mu_result condition_read(struct condition *c, const char *text, const struct condition_names *names,
                         char *why)
{
    struct reading r = {.c = c, .names = names, .why = why};
    *c = (struct condition){.body = CONDITION_ALL_ROBOTS};
    mu_result split = words_split(&r, text);
    if (split != MU_OK) {
        return split;
    }
    bool compares = r.count > 1 && strchr("<>", r.words[1][0]);
    if (compares && strcmp(r.words[0], "time") == 0) {
        c->kind = CONDITION_TIME;
        return compare_read(&r);
    }
    return compares && strrchr(r.words[0], '.') ? statistic_read(&r) : verb_read(&r);
}

/* --- is it so? -------------------------------------------------------------------------------- */

static bool compare(const struct condition *c, double value)
{
    switch (c->compare) {
    case CONDITION_ABOVE: return value > c->value;
    case CONDITION_NOT_BELOW: return value >= c->value;
    case CONDITION_BELOW: return value < c->value;
    case CONDITION_NOT_ABOVE: return value <= c->value;
    }
    return false;
}

static double number_of(const struct condition *c, const struct condition_view *view, int robot)
{
    struct condition_numbers numbers = {0};
    double value;
    view->numbers(view->self, robot, &numbers);
    memcpy(&value, (const char *)&numbers + c->number, sizeof value);
    return value;
}

static bool number_holds(const struct condition *c, const struct condition_view *view)
{
    if (c->body != CONDITION_ALL_ROBOTS) {
        return compare(c, number_of(c, view, c->body));
    }
    double sum = 0;
    int count = 0;
    for (int i = 0; i < view->robots; i++) {
        if (view->counts(view->self, i)) {
            sum += number_of(c, view, i);
            count++;
        }
    }
    return count > 0 && compare(c, sum / count);
}

static bool place_holds(const struct condition *c, const struct condition_view *view)
{
    struct condition_numbers one = {0}, other = {.x_m = c->x_m, .y_m = c->y_m};
    view->numbers(view->self, c->body, &one);
    if (c->kind == CONDITION_NEAR) {
        view->numbers(view->self, c->other, &other);
    }
    return hypot(one.x_m - other.x_m, one.y_m - other.y_m) <= c->value;
}

bool condition_holds(const struct condition *c, const struct condition_view *view, bool happened)
{
    bool holds = happened;
    switch (c->kind) {
    case CONDITION_TIME: return compare(c, view->time_s);
    case CONDITION_NUMBER: return number_holds(c, view);
    case CONDITION_NEAR:
    case CONDITION_AT: holds = place_holds(c, view); break;
    case CONDITION_STALLED: holds = view->stalled(view->self, c->body); break;
    case CONDITION_TOLD:
    case CONDITION_FIRED: break;
    }
    return holds != c->negated;
}

/* @return whether a word is in a list */
static bool list_has(const char *list, const char *word, char separator)
{
    size_t len = strlen(word);
    const char between[] = {separator, '\0'};
    for (const char *at = list; *at; at += strcspn(at, between), at += *at == separator) {
        if (strncmp(at, word, len) == 0 && (at[len] == '\0' || at[len] == separator)) {
            return true;
        }
    }
    return false;
}

bool condition_told(const struct condition *c, const char *content, const char *to)
{
    size_t len = strlen(c->word);
    const char *first = content + strspn(content, " ");
    bool same = strncmp(first, c->word, len) == 0 && (first[len] == '\0' || first[len] == ' ');
    return c->kind == CONDITION_TOLD && same &&
           (!c->to[0] || strcmp(c->to, to) == 0 || list_has(to, c->to, ','));
}

bool condition_fired(const struct condition *c, const char *rules)
{
    return c->kind == CONDITION_FIRED && list_has(rules, c->word, ' ');
}

bool condition_watch_look(struct condition_watch *w, const struct condition_view *view)
{
    bool momentary = w->condition.kind == CONDITION_TOLD || w->condition.kind == CONDITION_FIRED;
    bool holds = condition_holds(&w->condition, view, w->happened);
    bool came = holds && (!w->was || (momentary && !w->condition.negated));
    w->was = holds;
    w->happened = false;
    return came;
}

void condition_note_rules(struct condition_watch *w, int robot, const char *rules)
{
    const struct condition *c = &w->condition;
    bool asked = c->kind == CONDITION_FIRED && c->body == robot;
    w->happened = w->happened || (asked && condition_fired(c, rules));
}

void condition_note_mail(struct condition_watch *w, int robot, const char *content, const char *dst)
{
    const struct condition *c = &w->condition;
    bool asked = c->kind == CONDITION_TOLD && c->body == robot;
    w->happened = w->happened || (asked && condition_told(c, content, dst));
}
