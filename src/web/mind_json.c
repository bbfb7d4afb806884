/* SPDX-License-Identifier: Apache-2.0 */
#include "web/json.h"

#include "core/text.h"

#include <stdio.h>
#include <string.h>

static void text_write(struct mu_json *j, const char *text)
{
    char shown[MIND_JSON_TEXT_MAX + 1];
    mu_text_copy(shown, sizeof shown, text);
    mu_json_string(j, NULL, shown);
}

/* "see 12,9": two strings */
static void rule_write(struct mu_json *j, const char *text)
{
    char rule[MIND_JSON_TEXT_MAX + 1];
    size_t len = strcspn(text, " ");
    mu_text_copy(rule, len < sizeof rule ? len + 1 : sizeof rule, text);
    mu_json_string(j, NULL, rule);
    text_write(j, text + len + (text[len] == ' '));
}

static const char *text_of(const struct minds *m, int32_t line)
{
    size_t bytes;
    return minds_text(m, line, &bytes);
}

static void facts_write(struct mu_json *j, const struct minds *m, int32_t line)
{
    int count = 0;
    mu_json_list(j, "facts");
    for (int32_t f = minds_next_fact(m, line, MINDS_NONE);
         f != MINDS_NONE && count < MIND_JSON_FACTS_MAX; f = minds_next_fact(m, line, f), count++) {
        char index[32];
        snprintf(index, sizeof index, "f-%lld", m->lines[f].fact);
        mu_json_list(j, NULL);
        mu_json_string(j, NULL, index);
        text_write(j, text_of(m, f));
        mu_json_end(j);
    }
    mu_json_end(j);
}

/* What was left on it stands at the end of a step; the first of them is to fire first. */
static void agenda_write(struct mu_json *j, const struct minds *m, int32_t line)
{
    int32_t first = MINDS_NONE, last = line;
    for (int32_t at = line; at != MINDS_NONE && m->lines[at].letter == 'A';
         at = m->lines[at].before) {
        first = m->lines[at].step == m->lines[line].step ? at : first;
    }
    mu_json_list(j, "agenda");
    for (int32_t at = first; at != MINDS_NONE && at <= last; at++) {
        if (m->lines[at].robot == m->lines[line].robot) {
            mu_json_list(j, NULL);
            rule_write(j, text_of(m, at));
            mu_json_end(j);
        }
    }
    mu_json_end(j);
}

static void fired_write(struct mu_json *j, const struct minds *m, int32_t line)
{
    mu_json_list(j, "fired");
    for (int n = 0; n < MIND_JSON_FIRED_MAX && (line = minds_last(m, line, 'R')) != MINDS_NONE;
         n++) {
        mu_json_list(j, NULL);
        mu_json_uint(j, NULL, m->lines[line].step);
        rule_write(j, text_of(m, line));
        mu_json_end(j);
        line = m->lines[line].before;
    }
    mu_json_end(j);
}

static void mails_write(struct mu_json *j, const struct minds *m, int32_t line)
{
    mu_json_list(j, "mails");
    for (int n = 0; n < MIND_JSON_MAILS_MAX && line != MINDS_NONE; line = m->lines[line].before) {
        char letter = m->lines[line].letter;
        if (letter == 'M' || letter == 'T') {
            mu_json_list(j, NULL);
            mu_json_uint(j, NULL, m->lines[line].step);
            text_write(j, text_of(m, line));
            mu_json_bool(j, NULL, letter == 'T');
            mu_json_end(j);
            n++;
        }
    }
    mu_json_end(j);
}

/* @return the last line of a robot's diary up to a step, or MINDS_NONE */
static int32_t line_find(const struct minds *m, const char *robot, uint32_t step)
{
    int32_t index = minds_robot(m, robot);
    return index == MINDS_NONE ? MINDS_NONE : minds_at(m, index, step);
}

void mind_json_write(struct mu_json *j, const char *key, const struct minds *minds,
                     const char *robot, uint32_t step)
{
    int32_t line = line_find(minds, robot, step);
    mu_json_object(j, key);
    mu_json_string(j, "robot", robot);
    mu_json_int(j, "step", line == MINDS_NONE ? -1 : (int64_t)minds->lines[line].step);
    facts_write(j, minds, line);
    agenda_write(j, minds, line);
    fired_write(j, minds, line);
    mails_write(j, minds, line);
    mu_json_end(j);
}
