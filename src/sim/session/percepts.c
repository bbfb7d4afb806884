/* SPDX-License-Identifier: Apache-2.0 */
/* Sends each process what its robots sense. */
#include "sim/session/parts.h"

/* The lists of a percept go out as the engine has them. */
_Static_assert(sizeof(struct engine_blob) == sizeof(muster_Blob) &&
                   offsetof(struct engine_blob, bearing_rad) ==
                       offsetof(muster_Blob, bearing_rad) &&
                   offsetof(struct engine_blob, width_rad) == offsetof(muster_Blob, width_rad) &&
                   offsetof(struct engine_blob, range_m) == offsetof(muster_Blob, range_m),
               "blobs");
_Static_assert(
    sizeof(struct engine_fiducial) == sizeof(muster_Fiducial) &&
        offsetof(struct engine_fiducial, bearing_rad) == offsetof(muster_Fiducial, bearing_rad) &&
        offsetof(struct engine_fiducial, range_m) == offsetof(muster_Fiducial, range_m) &&
        offsetof(struct engine_fiducial, heading_rad) == offsetof(muster_Fiducial, heading_rad),
    "fiducials");

/* What nobody asks for is not read; a robot without a controller asks for nothing. */
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
    const struct engine_percept *percepts = engine_sense_all(s->engine, s->wanted);
    for (size_t r = 0; r < s->robot_count; r++) {
        s->robots[r].percept = percepts[r];
    }
}

/* What is not wanted is empty in the engine's percept. */
static void readings_fill(muster_Percept *to, const struct engine_percept *from)
{
    /* Nobody writes through these. */
    to->sonar_m._buffer = (float *)(uintptr_t)from->sonar_m;
    to->sonar_m._length = to->sonar_m._maximum = (uint32_t)from->sonar_count;
    to->laser_m._buffer = (float *)(uintptr_t)from->laser_m;
    to->laser_m._length = to->laser_m._maximum = (uint32_t)from->laser_count;
    to->blobs._buffer = (muster_Blob *)(uintptr_t)from->blobs;
    to->blobs._length = to->blobs._maximum = (uint32_t)from->blob_count;
    to->fiducials._buffer = (muster_Fiducial *)(uintptr_t)from->fiducials;
    to->fiducials._length = to->fiducials._maximum = (uint32_t)from->fiducial_count;
}

static void body_fill(muster_Percept *to, const struct engine_percept *from)
{
    to->x_m = from->position.x_m;
    to->y_m = from->position.y_m;
    to->heading_rad = from->position.heading_rad;
    to->forward_m_s = from->forward_m_s;
    to->turn_rad_s = from->turn_rad_s;
    to->stalled = from->stalled;
    to->fault = from->fault;
    to->gps_x_m = from->gps_x_m;
    to->gps_y_m = from->gps_y_m;
    to->compass_rad = from->compass_rad;
    to->odometer_x_m = from->odometer.x_m;
    to->odometer_y_m = from->odometer.y_m;
    to->odometer_heading_rad = from->odometer.heading_rad;
    to->bumpers = from->bumpers;
    to->gripper = from->gripper;
    to->battery_share = from->battery_share;
}

void percepts_fill(muster_Percept *to, const struct engine_percept *from)
{
    body_fill(to, from);
    readings_fill(to, from);
}

/* Who watches sees where each body is and how it moves, and nothing of what its sensors read. */
static void bodies_fill(struct session *s)
{
    for (size_t r = 0; r < s->robot_count; r++) {
        const struct engine_percept *percept = &s->robots[r].percept;
        body_fill(&s->bodies[r], percept);
        s->bodies[r].x_m = percept->pose.x_m;
        s->bodies[r].y_m = percept->pose.y_m;
        s->bodies[r].heading_rad = percept->pose.heading_rad;
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
                body_fill(&s->percepts[next], &s->robots[r].percept);
                readings_fill(&s->percepts[next++], &s->robots[r].percept);
            }
        }
        struct session_process *p = &s->processes[i];
        p->sample.step = s->step;
        p->sample.time_ns = (uint64_t)s->step * s->options.step_ns;
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

/* @return whether every process has its step */
bool percepts_retry(struct session *s)
{
    bool all = true;
    for (uint32_t i = 0; i < s->process_count; i++) {
        struct session_process *p = &s->processes[i];
        all = (!p->sample_pending || percepts_write(p)) && all;
    }
    if (s->roster_due) {
        s->roster_due = roster_tell(s, true) != MU_OK;
    }
    return all && !s->roster_due;
}
