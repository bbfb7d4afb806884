/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file percept.h
 * What a robot's body senses, made of the table in sensors.h.
 */
#ifndef MUSTER_PERCEPT_H
#define MUSTER_PERCEPT_H

#include "muster/sensors.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define MU_SENSOR_NUMBER_(id, ...)    MU_SENSOR_##id,
#define MU_SENSE_BIT_(id, ...)        MU_SENSE_##id = 1 << MU_SENSOR_##id,
#define MU_CHANNEL_NUMBER_(id, ...)   MU_CHANNEL_##id,
#define MU_MEMBER_(type, member, ...) type member;
#define MU_LIST_(id, senses, type, list, count, ...) \
    const type *list;                                \
    size_t count;

/* Sensors that a body reads only if its agent asks for them (mu_agent_senses), as numbers ... */
enum mu_sensor { MU_SENSORS(MU_SENSOR_NUMBER_) MU_SENSOR_COUNT };

/* ... and as bits: MU_SENSE_SONAR, ... */
enum mu_sense {
    MU_SENSORS(MU_SENSE_BIT_) MU_SENSES = (1 << MU_SENSOR_COUNT) - 1 /* all of them */
};

/* The lists of a percept. */
enum mu_channel_number { MU_CHANNELS(MU_CHANNEL_NUMBER_) MU_CHANNEL_COUNT };

/* A blob of colour in the camera's picture; angles from its middle. */
struct mu_blob {
    MU_BLOB(MU_MEMBER_)
};

/* A number that a thing bears, seen from the fiducial finder. */
struct mu_fiducial {
    MU_FIDUCIAL(MU_MEMBER_)
};

/* The state of a gripper; bits. */
enum mu_gripper {
    MU_GRIPPER_THERE = 1,
    MU_GRIPPER_CLOSED = 2,
    MU_GRIPPER_LIFTED = 4,
    MU_GRIPPER_OUTER_BEAM = 8, /* something breaks the beam at the tips of the paddles */
    MU_GRIPPER_INNER_BEAM = 16,
    MU_GRIPPER_HOLDS = 32
};

/* What a robot's body feels and sees at the start of a control step.  What it points to is valid
 * in the handler only. */
struct mu_percept {
    const char *robot; /* whose body it is */
    int64_t step;
    uint64_t time_ns;
    MU_READINGS(MU_MEMBER_)
    MU_CHANNELS(MU_LIST_)
};

#endif
