/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Lines that only look, answered between two steps.  A run in which somebody looks is the run in
 * which nobody does: what looking needs is put back as it was.
 */
#include "core/glance.h"
#include "mind/engine/value.h"
#include "mind/facts/facts.h"

#include <string.h>

/* What a call into CLIPS changes of itself. */
struct glance_before {
    uint64_t units, worked;
    uint32_t allocations, diary_lost;
    const char *stopped;
    long memory_max;
    bool ring_unseen;
    struct mu_text diary;
    long long next_fact;
    unsigned long long time_tag;
};

static struct glance_before glance_begin(struct mind *m)
{
    struct glance_before before = {.units = m->units,
                                   .worked = m->worked,
                                   .allocations = m->allocations,
                                   .stopped = m->stopped,
                                   .memory_max = m->memory_max,
                                   .ring_unseen = m->ring_unseen,
                                   .diary = m->diary,
                                   .diary_lost = m->diary_lost,
                                   .next_fact = FactData(m->env)->NextFactIndex,
                                   .time_tag = DefruleData(m->env)->CurrentEntityTimeTag};
    clips_env_enter(m, CLIPS_MODE_LINE);
    m->sheltered = false; /* a mind that is short of memory does not break because of a look */
    m->units = m->worked = 0;
    m->memory_max = LONG_MAX;
    percept_show(m);
    return before;
}

static void glance_end(struct mind *m, const struct glance_before *before)
{
    if (before->ring_unseen) {
        fact_retract(m, &m->ring_fact);
    }
    CleanCurrentGarbageFrame(m->env, NULL);
    FactData(m->env)->NextFactIndex = before->next_fact;
    DefruleData(m->env)->CurrentEntityTimeTag = before->time_tag;
    m->ring_unseen = before->ring_unseen;
    m->diary = before->diary;
    m->diary.at[m->diary.len] = '\0';
    m->diary_lost = before->diary_lost;
    m->units = before->units;
    m->worked = before->worked;
    m->allocations = before->allocations;
    m->stopped = before->stopped;
    m->memory_max = before->memory_max;
    (void)clips_env_leave(m);
}

/* Rules may have given a word of the list another meaning.  @return whether it is the engine's */
static bool glance_is_plain(struct mind *m, const char *line)
{
    char name[MU_GLANCE_LINE_MAX + 1];
    const char *word = line;
    size_t len = mu_glance_word(line, &word);
    if (len == 0) {
        return true;
    }
    memcpy(name, word, len);
    name[len] = '\0';
    return FindFunction(m->env, name) && !LookupDefgenericInScope(m->env, name) &&
           !LookupDeffunctionInScope(m->env, name);
}

/* @return whether CLIPS did it */
static bool glance_run(struct mind *m, const char *line)
{
    bool done = RouteCommand(m->env, line, TRUE);
    bool failed = GetEvaluationError(m->env) || GetHaltExecution(m->env);
    FlushPPBuffer(m->env);
    SetPPBufferStatus(m->env, OFF);
    return done && !failed;
}

mu_result mind_glance(struct mind *m, const char *line, struct mu_text *out)
{
    char sink_bytes[1];
    struct mu_text sink;
    size_t start = out->len;
    if (!m->env || !mu_glance_is(line) || !glance_is_plain(m, line)) {
        return MU_ABSENT;
    }
    mu_text_init(&sink, sink_bytes, sizeof sink_bytes);
    m->out = &sink; /* who watches facts does not see the one that is shown here alone */
    struct glance_before before = glance_begin(m);
    m->out = out;
    bool done = glance_run(m, line);
    m->out = &sink;
    glance_end(m, &before);
    m->out = NULL;
    clips_text_as_written(out->at + start);
    out->len = start + strlen(out->at + start);
    return done ? MU_OK : MU_MALFORMED;
}
