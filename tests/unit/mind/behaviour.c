/* SPDX-License-Identifier: Apache-2.0 */
/*
 * The library's behaviours in a closed loop: four minds drive discs on wheels on a walled floor
 * with boxes and pillars.  No physics: a move into something does not happen, and stalls the robot.
 */
#include "core/text_file.h"
#include "mind/mind.h"
#include "muster/limits.h"
#include "suite.h"

#include <CUnit/Basic.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { ROBOTS = 4, SONARS = 16, BOX_MAX = 256, CONTENT = 256, RUNS_MAX = 16 };

static const double pi = 3.14159265358979323846;
static const double step_s = 0.1;
static const double radius_m = 0.25;
static const double rim_m = 0.2;
static const double range_m = 5;

struct body {
    double x, y, heading, forward, turn;
    bool stalled;
    unsigned stalled_run, stalled_longest, near_mate, samples;
    double gone_m, mate_sum_m;
    struct mind *mind;
    char box[BOX_MAX][CONTENT];
    const char *from[BOX_MAX];
    size_t boxed;
    size_t index;
};

struct disc {
    double x, y, r;
};

struct box {
    double x0, y0, x1, y1;
};

/* 14 x 12 m, as the follow experiment has it: a few boxes, a few pillars. */
static const struct box boxes[] = {
    {-4.5, 2.5, -3.0, 3.3}, {2.5, -3.6, 3.2, -1.8}, {3.0, 2.6, 4.6, 3.2}, {-3.6, -3.4, -2.8, -2.6}};
static const struct disc pillars[] = {{0.3, 3.4, 0.3}, {0.2, -3.9, 0.35}, {5.3, 0.0, 0.3}};
static const double half_x_m = 7;
static const double half_y_m = 6;

static const char *const names[ROBOTS] = {"red", "blue", "green", "yellow"};
static struct body bodies[ROBOTS];
static struct mind *minds[RUNS_MAX * ROBOTS]; /* a mind's memory is for the life of the process */
static size_t mind_count;

static bool hits(double x, double y, double r, size_t self)
{
    if (fabs(x) > half_x_m - r || fabs(y) > half_y_m - r) {
        return true;
    }
    for (size_t i = 0; i < sizeof boxes / sizeof boxes[0]; i++) {
        double dx = fmax(fmax(boxes[i].x0 - x, x - boxes[i].x1), 0);
        double dy = fmax(fmax(boxes[i].y0 - y, y - boxes[i].y1), 0);
        if (hypot(dx, dy) <= r) {
            return true;
        }
    }
    for (size_t i = 0; i < sizeof pillars / sizeof pillars[0]; i++) {
        if (hypot(pillars[i].x - x, pillars[i].y - y) < r + pillars[i].r) {
            return true;
        }
    }
    for (size_t i = 0; i < ROBOTS; i++) {
        if (i != self && hypot(bodies[i].x - x, bodies[i].y - y) < r + radius_m) {
            return true;
        }
    }
    return false;
}

/* Marches along a ray: coarse, but without any geometry of its own to get wrong. */
static float cast(const struct body *b, double angle)
{
    double c = cos(b->heading + angle);
    double s = sin(b->heading + angle);
    for (double d = rim_m; d < range_m + rim_m; d += 0.04) {
        if (hits(b->x + c * d, b->y + s * d, 0, b->index)) {
            return (float)(d - rim_m);
        }
    }
    return (float)range_m;
}

static mu_result post(void *self, const struct mind_letter *letter)
{
    const struct body *sender = self;
    for (size_t i = 0; i < ROBOTS; i++) {
        struct body *to = &bodies[i];
        if (to != sender && to->boxed < BOX_MAX) {
            snprintf(to->box[to->boxed], CONTENT, "%s", letter->content);
            to->from[to->boxed++] = names[sender->index];
        }
    }
    return MU_OK;
}

static void complain(void *self, const char *text)
{
    const struct body *b = self;
    printf("%s: %s", names[b->index], text);
    if (strncmp(text, "rule ", 5) == 0) {
        CU_FAIL("a rule of the library ended in an error");
    }
}

static void sense(struct body *b, uint64_t time_ns)
{
    static const double looks[SONARS] = {90,  50,   30,   10,   -10, -30, -50, -90,
                                         -90, -130, -150, -170, 170, 150, 130, 90};
    float sonar[SONARS];
    for (size_t i = 0; i < SONARS; i++) {
        sonar[i] = cast(b, looks[i] / 180 * pi);
    }
    struct mu_percept p = {.time_ns = time_ns,
                           .x_m = b->x,
                           .y_m = b->y,
                           .heading_rad = b->heading,
                           .forward_m_s = b->forward,
                           .turn_rad_s = b->turn,
                           .stalled = b->stalled,
                           .sonar_count = SONARS,
                           .sonar_m = sonar};
    mind_percept(b->mind, &p);
}

static double towards(double now, double then, double most)
{
    return now + fmax(-most, fmin(then - now, most));
}

static void move(struct body *b, const struct mind_act *act)
{
    b->forward = towards(b->forward, act->drives ? act->forward_m_s : 0, 0.5 * step_s);
    b->turn = towards(b->turn, act->drives ? act->turn_rad_s : 0, 3.0 * step_s);
    double x = b->x + b->forward * step_s * cos(b->heading);
    double y = b->y + b->forward * step_s * sin(b->heading);
    b->heading = remainder(b->heading + b->turn * step_s, 2 * pi);
    b->stalled = fabs(b->forward) > 1e-6 && hits(x, y, radius_m, b->index);
    if (b->stalled) {
        b->forward = 0;
    } else {
        b->gone_m += hypot(x - b->x, y - b->y);
        b->x = x;
        b->y = y;
    }
    b->stalled_run = b->stalled ? b->stalled_run + 1 : 0;
    if (b->stalled_run > b->stalled_longest) {
        b->stalled_longest = b->stalled_run;
    }
}

static void step(uint64_t time_ns)
{
    static char arrived[ROBOTS][BOX_MAX][CONTENT];
    static const char *from[ROBOTS][BOX_MAX];
    size_t count[ROBOTS];
    static uint64_t id;
    struct mind_act acts[ROBOTS];
    for (size_t i = 0; i < ROBOTS; i++) {
        count[i] = bodies[i].boxed;
        memcpy(arrived[i], bodies[i].box, sizeof arrived[i]);
        memcpy(from[i], bodies[i].from, sizeof from[i]);
        bodies[i].boxed = 0;
    }
    for (size_t i = 0; i < ROBOTS; i++) {
        sense(&bodies[i], time_ns);
        for (size_t k = 0; k < count[i]; k++) {
            struct mind_mail mail = {++id, from[i][k], "", "", "", "", "", "", arrived[i][k], 0, 0};
            CU_ASSERT_EQUAL(mind_take_mail(bodies[i].mind, &mail), MU_OK);
        }
        mind_fire(bodies[i].mind, &acts[i]);
    }
    for (size_t i = 0; i < ROBOTS; i++) {
        move(&bodies[i], &acts[i]);
    }
}

static void say(struct body *b, const char *line)
{
    char bytes[512];
    struct mu_text out;
    mu_text_init(&out, bytes, sizeof bytes);
    CU_ASSERT_EQUAL(mind_line(b->mind, line, &out), MU_OK);
}

static void start(uint64_t seed)
{
    for (size_t i = 0; i < ROBOTS; i++) {
        struct mu_fault fault;
        struct body *b = &bodies[i];
        *b = (struct body){.x = 1.0 - 1.2 * (double)i, .index = i};
        struct mind_options options = {.read = mu_text_file_read,
                                       .name = names[i],
                                       .seed = seed,
                                       .rules_folder = "rules",
                                       .forward_max_m_s = 0.5,
                                       .turn_max_rad_s = pi / 2,
                                       .ports = {.self = b, .send = post, .print = complain}};
        mu_result r = mind_open(&b->mind, &options, &fault);
        if (r == MU_OK) {
            minds[mind_count++] = b->mind;
            r = mind_load(b->mind, "rules/follower.clp", &fault);
        }
        if (r != MU_OK) {
            mu_fault_print(&fault);
            exit(EXIT_FAILURE);
        }
    }
}

static void stop(void)
{
    for (size_t i = 0; i < ROBOTS; i++) {
        mind_close(bodies[i].mind);
    }
}

static void sample(size_t robot, size_t mate)
{
    struct body *b = &bodies[robot];
    double d = hypot(b->x - bodies[mate].x, b->y - bodies[mate].y);
    b->samples++;
    b->near_mate += d < 2.5;
    b->mate_sum_m += d;
}

static void report(uint64_t seed)
{
    for (size_t i = 0; i < ROBOTS && getenv("MUSTER_TEST_VERBOSE"); i++) {
        const struct body *b = &bodies[i];
        printf("seed %2llu %-6s gone %5.1f m  near mate %3.0f%%  mean %.2f m  stalled %u steps\n",
               (unsigned long long)seed, names[i], b->gone_m,
               b->samples ? 100.0 * b->near_mate / b->samples : 0,
               b->samples ? b->mate_sum_m / b->samples : 0, b->stalled_longest);
    }
}

static void follow_in_line(uint64_t seed)
{
    enum { STEPS = 1200, WARM_UP = 100 };
    start(seed);
    say(&bodies[0], "(wander)");
    say(&bodies[1], "(follow red)");
    say(&bodies[2], "(follow blue)");
    say(&bodies[3], "(follow green)");
    for (uint64_t n = 0; n < STEPS; n++) {
        step(n * MU_STEP_NS);
        for (size_t i = 1; i < ROBOTS && n > WARM_UP; i++) {
            sample(i, i - 1);
        }
    }
    report(seed);
    CU_ASSERT(bodies[0].gone_m > 25);
    for (size_t i = 0; i < ROBOTS; i++) {
        CU_ASSERT(bodies[i].stalled_longest < 20);
        CU_ASSERT(i == 0 || bodies[i].near_mate >= 0.8 * bodies[i].samples);
    }
    stop();
}

static void test_follow_in_line(void)
{
    const char *runs = getenv("MUSTER_TEST_RUNS");
    uint64_t count = runs ? strtoull(runs, NULL, 10) : 2;
    for (uint64_t seed = 1; seed <= count && seed < RUNS_MAX - 3; seed++) {
        follow_in_line(seed);
    }
}

static void test_leader_becomes_follower(void)
{
    start(1);
    say(&bodies[0], "(wander)");
    say(&bodies[1], "(follow red)");
    for (uint64_t n = 0; n < 300; n++) {
        step(n * MU_STEP_NS);
    }
    say(&bodies[2], "(wander)");
    say(&bodies[0], "(follow green)");
    for (uint64_t n = 300; n < 900; n++) {
        step(n * MU_STEP_NS);
        if (n > 500) {
            sample(0, 2);
        }
    }
    report(1);
    CU_ASSERT(bodies[0].near_mate >= 0.8 * bodies[0].samples);
    stop();
}

static void test_go_home(void)
{
    static const double homes[ROBOTS][2] = {{6, 5}, {-6, 5}, {-6, -5}, {6, -5}};
    start(1);
    for (size_t i = 0; i < ROBOTS; i++) {
        char line[64];
        snprintf(line, sizeof line, "(gohome %g %g)", homes[i][0] * 1000, homes[i][1] * 1000);
        say(&bodies[i], line);
    }
    for (uint64_t n = 0; n < 600; n++) {
        step(n * MU_STEP_NS);
    }
    report(1);
    for (size_t i = 0; i < ROBOTS; i++) {
        CU_ASSERT(hypot(bodies[i].x - homes[i][0], bodies[i].y - homes[i][1]) < 0.3);
    }
    stop();
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"three robots follow one that wanders", test_follow_in_line},
        {"the leader becomes a follower", test_leader_becomes_follower},
        {"gohome reaches the corners", test_go_home},
        CU_TEST_INFO_NULL,
    };
    return suite_run("mind/behaviour", tests);
}
