/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file wander.h
 * The same blind driver for every simulator of the benchmark: ahead, away from what is near, back
 * from what it has bumped into.  Each robot has random numbers of its own.
 */
#ifndef MUSTER_BENCH_WANDER_H
#define MUSTER_BENCH_WANDER_H

#include <stdbool.h>
#include <stdint.h>

enum { WANDER_SONARS = 16, WANDER_BEAMS = 180 };

#define WANDER_SONAR_M 5.0
#define WANDER_LASER_M 8.0
#define WANDER_SPEED   0.4

/* What a robot of the scene is and does, for the simulators that have no file for it. */
#define WANDER_LENGTH_M   0.44
#define WANDER_WIDTH_M    0.38
#define WANDER_MASS_KG    9.0
#define WANDER_ACCEL_M_S2 0.5
#define WANDER_TURN_ACCEL (3.14159265358979 / 2)
#define WANDER_FRICTION   0.6

struct wander {
    uint64_t dice;
    double forward_m_s, turn_rad_s; /* what it wants */
    int left;                       /* control steps until it changes its mind */
    bool backs_off;
};

static inline double wander_draw(struct wander *w)
{
    w->dice ^= w->dice << 13;
    w->dice ^= w->dice >> 7;
    w->dice ^= w->dice << 17;
    return (double)(w->dice >> 11) * 0x1p-53;
}

static inline void wander_start(struct wander *w, uint64_t robot)
{
    w->dice = 0x9e3779b97f4a7c15u * (robot + 1) + 1;
    w->forward_m_s = WANDER_SPEED;
    w->turn_rad_s = 0;
    w->left = 0;
    w->backs_off = false;
}

static inline double wander_least(double a, double b)
{
    return a < b ? a : b;
}

/* One control step, from the front six of a Pioneer's ring (1 is left); NULL: it sees nothing. */
static inline void wander_step(struct wander *w, const float *sonar_m, bool bumped)
{
    if (w->backs_off) {
        w->backs_off = --w->left > 0;
        w->left = w->backs_off ? w->left : 0;
        return;
    }
    w->forward_m_s = WANDER_SPEED;
    w->turn_rad_s = 0;
    if (sonar_m) {
        double left = wander_least(sonar_m[1], sonar_m[2]);
        double right = wander_least(sonar_m[5], sonar_m[6]);
        if (wander_least(sonar_m[3], sonar_m[4]) < 0.5 || left < 0.4 || right < 0.4) {
            w->forward_m_s = 0.05;
            w->turn_rad_s = left < right ? -1 : 1;
        }
    }
    if (w->left-- <= 0) {
        w->turn_rad_s += (wander_draw(w) - 0.5) * 1.5;
        w->left = 10 + (int)(wander_draw(w) * 30);
    }
    if (bumped) {
        w->backs_off = true;
        w->left = 5 + (int)(wander_draw(w) * 10);
        w->forward_m_s = -0.2;
        w->turn_rad_s = (wander_draw(w) - 0.5) * 3;
    }
}

#endif
