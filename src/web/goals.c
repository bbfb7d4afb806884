/* SPDX-License-Identifier: Apache-2.0 */
#include "web/goals.h"

#include "core/text.h"

#include <stdlib.h>
#include <string.h>

static const char GOAL[] = "(goal ";

static void text_take(struct goal *goal, long long fact, const char *at, size_t len)
{
    size_t head = sizeof GOAL - 1;
    if (len <= head || strncmp(at, GOAL, head) != 0) {
        return;
    }
    struct mu_text text;
    mu_text_init(&text, goal->text, sizeof goal->text);
    mu_text_add_bytes(&text, at + head, len - head - (at[len - 1] == ')'));
    goal->fact = fact;
}

void goals_fact(struct goal *goal, long long fact, const char *text)
{
    text_take(goal, fact, text, strlen(text));
}

/* "12 (goal wander)" */
static void fact_came(struct goal *goal, const char *line, size_t len)
{
    char *at;
    long long fact = strtoll(line, &at, 10);
    size_t head = (size_t)(at - line) + 1;
    if (len > head) {
        text_take(goal, fact, line + head, len - head);
    }
}

static void line_take(struct goal *goal, const char *line, size_t len)
{
    bool anew = line[0] == '0' && len == 1;
    bool gone = line[0] == '-' && strtoll(line + 1, NULL, 10) == goal->fact;
    if (anew || gone) {
        goal->fact = 0;
    } else if (line[0] == '+') {
        fact_came(goal, line + 1, len - 1);
    }
}

static void diary_take(struct goal *goal, const char *diary)
{
    while (*diary) {
        size_t len = strcspn(diary, "\n");
        if (len > 0) {
            line_take(goal, diary, len);
        }
        diary += len + (diary[len] == '\n');
    }
}

/* Acts come in the order of robots, with gaps. */
static struct goal *goal_of(struct goals *g, const muster_Frame *frame, const char *name,
                            uint32_t *from)
{
    uint32_t count = frame->robots._length < MU_ROBOTS_MAX ? frame->robots._length : MU_ROBOTS_MAX;
    for (uint32_t n = 0; n < count; n++) {
        uint32_t i = (*from + n) % count;
        if (strcmp(frame->robots._buffer[i].name, name) == 0) {
            *from = i + 1;
            return &g->robots[i];
        }
    }
    return NULL;
}

void goals_take(struct goals *g, const muster_Frame *frame)
{
    uint32_t from = 0;
    if (frame->step != g->step + 1) {
        memset(g, 0, sizeof *g);
    }
    g->step = frame->step;
    for (uint32_t i = 0; i < frame->acts._length; i++) {
        const muster_Act *a = &frame->acts._buffer[i];
        struct goal *goal = a->diary[0] ? goal_of(g, frame, a->agent, &from) : NULL;
        if (goal) {
            diary_take(goal, a->diary);
            g->known = g->known || goal->fact != 0;
        }
    }
}

void goals_write(struct mu_json *j, const char *key, const struct goals *g, uint32_t robots)
{
    mu_json_list(j, key);
    for (uint32_t i = 0; i < robots && i < MU_ROBOTS_MAX && g->known; i++) {
        mu_json_string(j, NULL, g->robots[i].fact ? g->robots[i].text : "");
    }
    mu_json_end(j);
}
