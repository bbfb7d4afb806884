/* SPDX-License-Identifier: Apache-2.0 */
/* Sends each process what its robots sense. */
#include "bus/wire/percept.h"
#include "sim/session/parts.h"

/* A sensor that is not asked for is not read; a robot without a controller asks for nothing. */
static void wanted_set(struct session *s)
{
    for (size_t r = 0; r < s->robot_count; r++) {
        const struct session_robot *robot = &s->robots[r];
        s->wanted[r] = s->agents.at[r].process >= 0 ? robot->senses & ~robot->off : 0;
    }
}

void percepts_read(struct session *s)
{
    wanted_set(s);
    const struct engine_sample *samples = engine_sense_all(s->engine, s->wanted);
    for (size_t r = 0; r < s->robot_count; r++) {
        s->robots[r].sensed = samples[r];
    }
}

/* A watcher sees where each body is and how it moves, and nothing of what its sensors read. */
static void bodies_fill(struct session *s)
{
    for (size_t r = 0; r < s->robot_count; r++) {
        struct mu_percept body = engine_truth(&s->robots[r].sensed);
        percept_pack(&s->bodies[s->step & 1][r], &body);
    }
}

void percepts_set_step(const struct session *s, struct session_process *p, int64_t step)
{
    p->sample.step = step;
    p->sample.time_ns = (uint64_t)step * s->options.step_ns;
    if (p->sight != MEMBER_HAS_BODIES) {
        p->sample.robots._buffer = s->bodies[step & 1];
    }
}

bool percepts_write(struct session_process *p)
{
    p->sample_pending = bus_write(&p->sense, &p->sample) != MU_OK;
    return !p->sample_pending;
}

void percepts_fill_samples(struct session *s, bool last)
{
    uint32_t next = 0;
    bodies_fill(s);
    for (uint32_t i = 0; i < s->process_count; i++) {
        for (size_t r = 0; r < s->robot_count; r++) {
            if (s->agents.at[r].process == (int32_t)i) {
                percept_pack(&s->percepts[next++], &s->robots[r].sensed.percept);
            }
        }
        struct session_process *p = &s->processes[i];
        percepts_set_step(s, p, s->step);
        p->sample.last = last;
    }
}

void percepts_send(struct session *s, bool last)
{
    percepts_fill_samples(s, last);
    s->answers_missing = 0;
    for (uint32_t i = 0; i < s->process_count; i++) {
        struct session_process *p = &s->processes[i];
        if (member_is_in_steps(p)) {
            (void)percepts_write(p);
            s->answers_missing++;
        }
    }
    s->sent_step = s->step;
}

/* The successor of a watcher follows when its answer to the step before is with the broker. */
static void step_follow(const struct session *s, struct session_process *p)
{
    if (p->sample.step == s->sent_step - 1 && s->mail_step == p->sample.step) {
        percepts_set_step(s, p, s->sent_step);
        p->sample_pending = true;
    }
}

/* @return whether every process has its step */
bool percepts_retry(struct session *s)
{
    bool all = true;
    for (uint32_t i = 0; i < s->process_count; i++) {
        struct session_process *p = &s->processes[i];
        step_follow(s, p);
        all = (!p->sample_pending || percepts_write(p)) && all;
    }
    if (s->roster_due) {
        s->roster_due = roster_tell(s, true) != MU_OK;
    }
    return all && !s->roster_due;
}
