/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Makes a robot's mind: of its rules, of its checkpoint, and anew when it is broken; with the map
 * of the world.
 */
#include "agent/robot.h"
#include "core/fault.h"
#include "core/log.h"
#include "core/text_file.h"
#include "muster/memory.h"
#include "planner/planner.h"
#include "world/world_load.h"

#include <inttypes.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

/* Half a Pioneer, for a robot that does not stand in the world's file. */
static const double map_half_m = 0.19;

/* The margin of a robot beside its body. */
static const double map_beside_m = 0.06;

mu_result robot_mind_open_map(struct group_process *g)
{
    struct mu_fault fault;
    if (!g->set->world) {
        return MU_OK;
    }
    struct distance_map *map = mu_startup_alloc(sizeof *map);
    g->world = mu_startup_alloc(sizeof *g->world);
    mu_result loaded = world_load(g->world, g->set->world, true, &fault);
    if (loaded != MU_OK) {
        mu_fault_print(&fault);
        return loaded;
    }
    distance_map_make(map, g->world);
    g->planner = planner_make(map);
    return MU_OK;
}

/* @return half the width of a robot, with its margin, in metres */
static double map_half_width_m(const struct robot *r)
{
    const struct world *world = r->group->world;
    for (size_t i = 0; world && i < world->robot_count; i++) {
        if (strcmp(world->robots[i].name, r->name) == 0) {
            return world->robots[i].width_m / 2 + map_beside_m;
        }
    }
    return map_half_m + map_beside_m;
}

mu_result robot_mind_set_global(struct mind *mind, const char *word)
{
    char name[MU_FIELD_MAX + 1];
    const char *equals = strchr(word, '=');
    size_t len = equals ? (size_t)(equals - word) : 0;
    if (len == 0 || len >= sizeof name) {
        fprintf(stderr, "--global %s: expected NAME=VALUE\n", word);
        return MU_FAULT_USAGE;
    }
    memcpy(name, word, len);
    name[len] = '\0';
    if (mind_set_global(mind, name, equals + 1) != MU_OK) {
        fprintf(stderr, "--global %s: no such global, or not a CLIPS field\n", word);
        return MU_FAULT_USAGE;
    }
    return MU_OK;
}

static mu_result globals_set(struct mind *mind, const struct mu_option_list *globals)
{
    for (size_t i = 0; i < globals->count; i++) {
        MU_TRY(robot_mind_set_global(mind, globals->items[i]));
    }
    return MU_OK;
}

struct mind_options robot_mind_options(struct robot *r, const char *folder)
{
    const struct robot_options *set = r->group->set;
    return (struct mind_options){.read = mu_text_file_read,
                                 .name = r->name,
                                 .seed = (uint64_t)set->seed,
                                 .rules_folder = folder,
                                 .rules_file = set->rules,
                                 .firings_max = (uint32_t)set->firings_max,
                                 .failures_max = (uint32_t)set->failures_max,
                                 .trace = set->diary,
                                 .planner = r->group->planner,
                                 .half_m = map_half_width_m(r),
                                 .ports = ports_of(r)};
}

/* @return whether the mind was made of the checkpoint */
static bool mind_restored(struct robot *r, struct checkpoint_head *head, struct snapshot_header *p)
{
    struct mu_fault fault;
    struct mind_options options = robot_mind_options(r, NULL);
    const char *snapshot = checkpoint_read(r->group, r->name, head, p);
    if (!snapshot) {
        return false;
    }
    mu_result made = mind_begin(r->mind, &options, &fault);
    made = made == MU_OK ? mind_restore(r->mind, snapshot, strlen(snapshot), &fault) : made;
    if (made != MU_OK) {
        mu_log(MU_LOG_WARNING, "checkpoint-refused", "name=%s line=%d %s", r->name, fault.line,
               fault.text);
        mind_close(r->mind);
    }
    return made == MU_OK;
}

void robot_mind_take_up(struct robot *r, const struct checkpoint_head *head)
{
    robot_state_enter(&r->state, ROBOT_RECALLS);
    r->saved_step = head->step;
    r->answer = head->answer;
    if (head->answer.text) { /* the buffer is used for other files */
        r->answer.text =
            memcpy(mu_startup_alloc(head->answer.len + 1), head->answer.text, head->answer.len);
    }
}

/* @return whether the robot goes on where its checkpoint ends */
static bool mind_return(struct robot *r)
{
    struct checkpoint_head head;
    struct snapshot_header p;
    if (!mind_restored(r, &head, &p)) {
        return false;
    }
    robot_mind_take_up(r, &head);
    r->returns_as = p.state;
    r->passage = p.passage;
    r->mails = p.mails;
    return true;
}

static mu_result mind_make(struct robot *r, const char *folder)
{
    const struct robot_options *set = r->group->set;
    struct mind_options options = robot_mind_options(r, folder);
    struct mu_fault fault;
    mu_result made = mind_begin(r->mind, &options, &fault);
    made = made == MU_OK ? mind_load(r->mind, set->rules, &fault) : made;
    if (made != MU_OK) {
        mu_fault_print(&fault);
        return made;
    }
    return globals_set(r->mind, &set->globals);
}

mu_result robot_mind_make(struct robot *r)
{
    bool restore = r->group->set->checkpoints.restore;
    r->mind = mind_reserve();
    checkpoint_set_native(r, true);
    aside_open(r, restore);
    if (restore && mind_return(r)) {
        return MU_OK;
    }
    if (restore && checkpoint_is_gone(r->group, r->name)) {
        mu_log(MU_LOG_INFO, "gone", "name=%s", r->name);
        return MU_OK;
    }
    robot_state_enter(&r->state, ROBOT_BEGINS);
    return mind_make(r, r->group->rules_folder);
}

/* @return whether the mind was made anew */
static bool mind_again(struct robot *r, const char **made_of)
{
    const struct robot_options *set = r->group->set;
    struct checkpoint_head head;
    struct snapshot_header p;
    mind_close(r->mind);
    *made_of = "checkpoint";
    if (set->checkpoints.every_s > 0 && mind_restored(r, &head, &p)) {
        return true;
    }
    *made_of = "rules";
    return set->rules && mind_make(r, r->group->rules_folder) == MU_OK;
}

bool robot_mind_mend(struct robot *r)
{
    const char *made_of;
    if (!mind_is_broken(r->mind) || r->mends >= r->group->set->mends_max) {
        return false;
    }
    r->mends++;
    if (!mind_again(r, &made_of)) {
        mu_log(MU_LOG_ERROR, "mind-gone", "name=%s", r->name);
        return false;
    }
    mu_log(MU_LOG_WARNING, "mind-mended", "name=%s of=%s time=%" PRId64, r->name, made_of,
           r->mends);
    mind_event(r->mind, MU_ON_ARRIVE);
    return true;
}

/* --- minds whose engine does not come back ------------------------------------------------------
 */

/*
 * Time is the processor's, of this thread: neither a machine that has much to do nor a process that
 * was stopped is taken for an engine that hangs.
 */

/* glibc 2.36 has no name for it. */
#ifndef sigev_notify_thread_id
#define sigev_notify_thread_id _sigev_un._tid
#endif

enum { MIND_LOOK_MS = 250 };

static void mind_timer(int number)
{
    (void)number;
    char bytes[320];
    struct mu_text why = mu_text_in(bytes, sizeof bytes);
    int code = mind_look(MIND_LOOK_MS, &why);
    if (code != MIND_WAITS) {
        ssize_t written = write(STDERR_FILENO, why.at, why.len);
        (void)written; /* no agent to tell */
        _exit(code);
    }
}

void robot_mind_watch(void)
{
    timer_t timer;
    /* No mask: from a look the way may lead out of the engine. */
    struct sigaction look = {.sa_handler = mind_timer, .sa_flags = SA_RESTART | SA_NODEFER};
    struct sigevent event = {.sigev_notify = SIGEV_THREAD_ID, .sigev_signo = SIGPROF};
    struct itimerspec every = {.it_interval.tv_nsec = MIND_LOOK_MS * 1000000,
                               .it_value.tv_nsec = MIND_LOOK_MS * 1000000};
    event.sigev_notify_thread_id = gettid();
    bool set = sigaction(SIGPROF, &look, NULL) == 0 &&
               timer_create(CLOCK_THREAD_CPUTIME_ID, &event, &timer) == 0 &&
               timer_settime(timer, 0, &every, NULL) == 0;
    MU_ASSERT(set);
}
