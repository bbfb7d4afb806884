/* SPDX-License-Identifier: Apache-2.0 */
#include "story/story.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { WHY_DEEP_MAX = 24, WHY_TOLD_MAX = 256, WHY_TEXT_SHOWN = 160, WHY_LOOKED_MAX = 200000000 };

/* One chain while it is told. */
struct chain {
    const struct why *why;
    int32_t told[WHY_TOLD_MAX]; /* lines that need not be told again */
    size_t told_count;
    int64_t looked; /* lines that facts were looked for in */
    uint32_t ends;
};

static void fact_tell(struct chain *c, int32_t line, int deep);

static void indent(const struct chain *c, int deep)
{
    static const char blanks[2 * WHY_DEEP_MAX + 1] =
        "                                                ";
    mu_text_add_bytes(c->why->out, blanks, 2 * (size_t)deep);
}

/* Adds a line's text behind words; a long one is cut. */
static void words_add(const struct chain *c, int deep, const char *words, int32_t line)
{
    size_t bytes;
    const char *text = minds_text(c->why->minds, line, &bytes);
    bool cut = bytes > WHY_TEXT_SHOWN;
    indent(c, deep);
    mu_text_add(c->why->out, words);
    mu_text_add_plain(c->why->out, text, cut ? WHY_TEXT_SHOWN : bytes);
    mu_text_add(c->why->out, cut ? " ..." : "");
}

static void time_add(const struct chain *c, int32_t line)
{
    mu_text_format(c->why->out, ", at %.1f s\n", c->why->minds->lines[line].step * c->why->step_s);
}

static void leaf_tell(struct chain *c, int32_t line, int deep, const char *words, enum why_end end)
{
    words_add(c, deep, words, line);
    time_add(c, line);
    c->ends |= end;
}

static void body_tell(struct chain *c, struct interventions_asked on, int deep)
{
    char before[2 * WHY_DEEP_MAX + sizeof "intervention: "];
    snprintf(before, sizeof before, "%*sintervention: ", 2 * deep, "");
    on.step_s = c->why->step_s;
    c->ends |= interventions_tell(c->why->interventions, &on, before, c->why->out) > 0
                   ? WHY_INTERVENTION
                   : 0;
}

/* A percept shows what was done at the end of the step before. */
static void percept_tell(struct chain *c, int32_t line, int deep)
{
    const struct minds *m = c->why->minds;
    uint32_t step = m->lines[line].step;
    leaf_tell(c, line, deep, "sensed", WHY_SENSED);
    body_tell(c,
              (struct interventions_asked){.robot = m->robots[m->lines[line].robot].name,
                                           .since = step > 0 ? step - 1 : 0,
                                           .step = step,
                                           .sensed = true},
              deep + 1);
}

static bool was_told(struct chain *c, int32_t line)
{
    for (size_t i = 0; i < c->told_count; i++) {
        if (c->told[i] == line) {
            return true;
        }
    }
    if (c->told_count < WHY_TOLD_MAX) {
        c->told[c->told_count++] = line;
    }
    return c->told_count == WHY_TOLD_MAX;
}

static size_t match_bytes(const char *at, const char *end)
{
    const char *comma = memchr(at, ',', (size_t)(end - at));
    return (size_t)((comma ? comma : end) - at);
}

/* Looks for what a rule has matched; a diary that sends us back and forth without end is given up.
 */
static int32_t match_find(struct chain *c, int32_t line, long long index)
{
    const struct minds *m = c->why->minds;
    int32_t fact = c->looked < WHY_LOOKED_MAX ? minds_fact(m, line, index) : MINDS_NONE;
    c->looked += line - (fact == MINDS_NONE ? 0 : fact);
    return fact;
}

/* What a rule has matched: "NAME 12,[ball],*". */
static void rule_tell(struct chain *c, int32_t line, int deep)
{
    size_t bytes;
    const char *text = minds_text(c->why->minds, line, &bytes);
    const char *end = text + bytes;
    const char *at = memchr(text, ' ', bytes);
    words_add(c, deep, "rule ", line);
    time_add(c, line);
    while (at && ++at < end) {
        long long index = strtoll(at, NULL, 10);
        bool is_fact = *at != '*' && *at != '[';
        int32_t fact = is_fact ? match_find(c, line, index) : MINDS_NONE;
        if (fact != MINDS_NONE) {
            fact_tell(c, fact, deep + 1);
        } else if (*at == '[') { /* diaries do not follow instances */
            indent(c, deep + 1);
            mu_text_format(c->why->out, "%.*s\n", (int)match_bytes(at, end), at);
        } else if (*at != '*') {
            indent(c, deep + 1);
            mu_text_format(c->why->out, "f-%lld: %s\n", index,
                           c->looked < WHY_LOOKED_MAX ? "the diary does not have it"
                                                      : "there is too much to look through");
            c->ends |= WHY_UNKNOWN;
        }
        at = memchr(at, ',', (size_t)(end - at));
    }
}

/* Behind so many words. */
static const char *words_skip(const char *text, const char *end, int words)
{
    for (; text < end && words > 0; text++) {
        words -= *text == ' ';
    }
    return text;
}

/* The sender's line that sent a mail: the last one up to its step with the same content. */
static int32_t mail_origin(const struct minds *m, int32_t mail)
{
    size_t bytes, sent_bytes;
    char name[64];
    const char *text = minds_text(m, mail, &bytes);
    const char *blank = memchr(text, ' ', bytes);
    size_t len = blank ? (size_t)(blank - text) : 0;
    if (len == 0 || len >= sizeof name) {
        return MINDS_NONE;
    }
    memcpy(name, text, len);
    name[len] = '\0';
    int32_t sender = minds_robot(m, name);
    const char *content = words_skip(text, text + bytes, 2);
    size_t content_bytes = (size_t)(text + bytes - content);
    int32_t line = sender == MINDS_NONE ? MINDS_NONE : minds_at(m, sender, m->lines[mail].step);
    for (line = minds_last(m, line, 'T'); line != MINDS_NONE;
         line = minds_last(m, m->lines[line].before, 'T')) {
        const char *sent = minds_text(m, line, &sent_bytes);
        const char *said = words_skip(sent, sent + sent_bytes, 1);
        if ((size_t)(sent + sent_bytes - said) == content_bytes &&
            memcmp(said, content, content_bytes) == 0) {
            return line;
        }
    }
    return MINDS_NONE;
}

static void cause_tell(struct chain *c, int32_t line, int deep);

static void mail_tell(struct chain *c, int32_t line, int deep)
{
    const struct minds *m = c->why->minds;
    int32_t origin = mail_origin(m, line);
    if (origin == MINDS_NONE) {
        leaf_tell(c, line, deep, "a mail of ", WHY_MAIL);
        return;
    }
    words_add(c, deep, "a mail of ", line);
    time_add(c, line);
    indent(c, deep + 1 < WHY_DEEP_MAX ? deep + 1 : WHY_DEEP_MAX);
    mu_text_format(c->why->out, "sent by %s:\n", m->robots[m->lines[origin].robot].name);
    c->ends |= WHY_MAIL;
    cause_tell(c, m->lines[origin].cause, deep + 2);
}

/* What is behind a line, down to where nothing is. */
static void cause_tell(struct chain *c, int32_t line, int deep)
{
    if (line == MINDS_NONE || deep >= WHY_DEEP_MAX) {
        c->ends |= WHY_UNKNOWN;
        return;
    }
    switch (c->why->minds->lines[line].letter) {
    case 'S': percept_tell(c, line, deep); break;
    case 'L': leaf_tell(c, line, deep, "a line: ", WHY_LINE); break;
    case 'E': leaf_tell(c, line, deep, "event ", WHY_EVENT); break;
    case '0': leaf_tell(c, line, deep, "there when the mind began", WHY_RULES); break;
    case 'M': mail_tell(c, line, deep); break;
    case 'R': rule_tell(c, line, deep); break;
    default: c->ends |= WHY_UNKNOWN; break;
    }
}

static void fact_tell(struct chain *c, int32_t line, int deep)
{
    char words[32];
    if (deep >= WHY_DEEP_MAX) {
        c->ends |= WHY_UNKNOWN;
        return;
    }
    struct mu_text text = mu_text_in(words, sizeof words);
    mu_text_format(&text, "f-%lld ", c->why->minds->lines[line].fact);
    words_add(c, deep, words, line);
    if (was_told(c, line)) {
        mu_text_add(c->why->out, ": see above\n");
        return;
    }
    mu_text_add(c->why->out, "\n");
    cause_tell(c, c->why->minds->lines[line].cause, deep + 1);
}

uint32_t why_speed(const struct why *w, int32_t robot, uint32_t step)
{
    struct chain c = {.why = w};
    int32_t line = minds_last(w->minds, minds_at(w->minds, robot, step), 'V');
    if (line != MINDS_NONE) {
        words_add(&c, 0, "speed and turn rate (mm/s, deg/s) ", line);
        time_add(&c, line);
        cause_tell(&c, w->minds->lines[line].cause, 1);
    }
    body_tell(
        &c,
        (struct interventions_asked){.robot = w->minds->robots[robot].name,
                                     .since = line == MINDS_NONE ? 0 : w->minds->lines[line].step,
                                     .step = step + 1},
        0);
    return c.ends;
}

uint32_t why_fact(const struct why *w, int32_t robot, uint32_t step, long long index)
{
    struct chain c = {.why = w};
    int32_t line = minds_fact(w->minds, minds_at(w->minds, robot, step), index);
    if (line == MINDS_NONE) {
        return 0;
    }
    fact_tell(&c, line, 0);
    return c.ends;
}
