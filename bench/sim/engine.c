/* SPDX-License-Identifier: Apache-2.0 */
/*
 * The benchmark's scene in our own engine, without network or rules.
 *   engine WORLD SECONDS LASER THREADS
 * prints CPU and wall seconds a simulated second, metres a second driven, hashes of the bodies and
 * of what was read last, and the most memory that it had in kB.
 */
#include "sim/engine/engine.h"
#include "muster/memory.h"
#include "wander.h"
#include "world/world_load.h"

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
#define HASH_START 1469598103934665603ull

static uint64_t hash_fold(uint64_t hash, uint64_t bits)
{
    return (hash ^ bits) * 1099511628211ull;
}

static uint64_t hash_bodies(const struct engine *e, uint64_t hash)
{
    double state[ENGINE_STATE_DOUBLES];
    for (size_t i = 0; i < engine_body_count(e); i++) {
        engine_state(e, i, state);
        for (size_t k = 0; k < ENGINE_STATE_DOUBLES; k++) {
            uint64_t bits;
            memcpy(&bits, &state[k], sizeof bits);
            hash = hash_fold(hash, bits);
        }
    }
    return hash;
}

static uint64_t hash_ranges(const float *range_m, size_t count, uint64_t hash)
{
    for (size_t k = 0; k < count; k++) {
        uint32_t bits;
        memcpy(&bits, &range_m[k], sizeof bits);
        hash = hash_fold(hash, bits);
    }
    return hash;
}

/* The most memory that this program has had, in kB; getrusage would count its parent's. */
static long memory_kb(void)
{
    FILE *f = fopen("/proc/self/status", "r");
    char line[128];
    long kb = 0;
    while (f && fgets(line, sizeof line, f)) {
        if (sscanf(line, "VmHWM: %ld", &kb) == 1) {
            break;
        }
    }
    if (f) {
        fclose(f);
    }
    return kb;
}

struct bench {
    struct engine *engine;
    size_t robots;
    struct wander *minds;
    uint32_t *wanted;
    uint64_t seen; /* hash of all that was read */
    double way;    /* sum of the robots' mean speeds */
};

static void step(struct bench *b)
{
    const struct engine_sample *percepts = engine_sense_all(b->engine, b->wanted);
    for (size_t i = 0; i < b->robots; i++) {
        const struct engine_sample *p = &percepts[i];
        wander_step(&b->minds[i], p->percept.sonar_m, p->percept.bumpers != 0);
        double forward_m_s = b->minds[i].forward_m_s;
        double turn_rad_s = b->minds[i].turn_rad_s;
        MU_ASSERT(engine_command(b->engine, i, &forward_m_s, &turn_rad_s) == MU_OK);
        b->way += fabs(p->percept.forward_m_s) / (double)b->robots;
    }
    engine_step(b->engine);
}

/* What the last step read, which is outside the time that counts. */
static void note_last(struct bench *b)
{
    const struct engine_sample *percepts = engine_sense_all(b->engine, b->wanted);
    for (size_t i = 0; i < b->robots; i++) {
        b->seen =
            hash_ranges(percepts[i].percept.sonar_m, percepts[i].percept.sonar_count, b->seen);
        b->seen =
            hash_ranges(percepts[i].percept.laser_m, percepts[i].percept.laser_count, b->seen);
    }
}

static void bench_open(struct bench *b, const struct world *world, bool laser, size_t threads)
{
    struct engine_options options = {.seed = 1, .step_ns = MU_STEP_NS, .threads = threads};
    b->engine = engine_open(world, &options);
    b->robots = world->robot_count;
    b->minds = mu_startup_array(b->robots, sizeof *b->minds);
    b->wanted = mu_startup_array(b->robots, sizeof *b->wanted);
    b->seen = HASH_START;
    for (size_t i = 0; i < b->robots; i++) {
        wander_start(&b->minds[i], i);
        b->wanted[i] = MU_SENSE_SONAR | (laser ? MU_SENSE_LASER : 0);
    }
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
    struct bench b = {0};
    bench_open(&b, &world, argv[3][0] == '1', strtoul(argv[4], NULL, 10));
    int steps = (int)(10 * strtod(argv[2], NULL));
    double wall = seconds(CLOCK_MONOTONIC);
    double cpu = seconds(CLOCK_PROCESS_CPUTIME_ID);
    for (int k = 0; k < steps; k++) {
        step(&b);
    }
    wall = seconds(CLOCK_MONOTONIC) - wall;
    cpu = seconds(CLOCK_PROCESS_CPUTIME_ID) - cpu;
    note_last(&b);
    printf("%.9g %.9g %.4f %016llx %016llx %ld\n", cpu / (steps * 0.1), wall / (steps * 0.1),
           b.way / steps, (unsigned long long)hash_bodies(b.engine, HASH_START),
           (unsigned long long)b.seen, memory_kb());
    engine_close(b.engine);
    return 0;
}
