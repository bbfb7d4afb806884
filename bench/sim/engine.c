/* SPDX-License-Identifier: Apache-2.0 */
/*
 * The benchmark's scene in our own engine, without network or rules.
 *   engine WORLD SECONDS LASER THREADS
 * prints CPU and wall seconds a simulated second, metres a second driven, and a hash of the bodies.
 */
#include "wander.h"
#include "muster/memory.h"
#include "sim/engine.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

static double seconds(clockid_t clock)
{
    struct timespec t;
    clock_gettime(clock, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* FNV-1a, by 64 bits. */
static uint64_t hash_robot(const struct engine *e, size_t robot, uint64_t hash)
{
    double state[ENGINE_STATE_DOUBLES];
    engine_state(e, robot, state);
    for (size_t k = 0; k < ENGINE_STATE_DOUBLES; k++) {
        uint64_t bits;
        memcpy(&bits, &state[k], sizeof bits);
        hash = (hash ^ bits) * 1099511628211ull;
    }
    return hash;
}

/* One control step of all robots.  @return how fast they are, on average */
static double step(struct engine *e, struct wander *minds, size_t robots)
{
    double speed = 0;
    for (size_t i = 0; i < robots; i++) {
        struct engine_percept percept;
        engine_sense(e, i, &percept);
        wander_step(&minds[i], percept.sonar_m, percept.stalled);
        double forward_m_s = minds[i].forward_m_s;
        double turn_rad_s = minds[i].turn_rad_s;
        MU_ASSERT(engine_command(e, i, &forward_m_s, &turn_rad_s) == MU_OK);
        speed += fabs(percept.forward_m_s) / (double)robots;
    }
    engine_step(e);
    return speed;
}

int main(int argc, char **argv)
{
    if (argc != 5) {
        fprintf(stderr, "usage: engine WORLD SECONDS LASER THREADS\n");
        return 2;
    }
    static struct world world;
    struct mu_fault fault;
    if (world_load(&world, argv[1], true, &fault) != MU_OK) {
        mu_fault_print(&fault);
        return 3;
    }
    struct engine_options options = {.seed = 1, .step_ns = MU_STEP_NS};
    struct engine *e = engine_open(&world, &options);
    struct wander *minds = mu_startup_array(world.robot_count, sizeof *minds);
    for (size_t i = 0; i < world.robot_count; i++) {
        wander_start(&minds[i], i);
    }
    int steps = (int)(10 * strtod(argv[2], NULL));
    double way = 0;
    double wall = seconds(CLOCK_MONOTONIC);
    double cpu = seconds(CLOCK_PROCESS_CPUTIME_ID);
    for (int k = 0; k < steps; k++) {
        way += step(e, minds, world.robot_count) / steps;
    }
    wall = seconds(CLOCK_MONOTONIC) - wall;
    cpu = seconds(CLOCK_PROCESS_CPUTIME_ID) - cpu;
    uint64_t hash = 1469598103934665603ull;
    for (size_t i = 0; i < world.robot_count; i++) {
        hash = hash_robot(e, i, hash);
    }
    printf("%.9g %.9g %.4f %016llx\n", cpu / (steps * 0.1), wall / (steps * 0.1), way,
           (unsigned long long)hash);
    return 0;
}
