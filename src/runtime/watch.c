/* SPDX-License-Identifier: Apache-2.0 */
#include "runtime/watch.h"

#include "core/built.h"
#include "core/clock.h"
#include "core/forks.h"
#include "core/signals.h"
#include "core/text.h"
#include "muster/memory.h"
#include "runtime/process.h"

#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* A Scene comes before Frames; a watch without a Scene shows Frames after this time. */
static const uint64_t SCENE_PATIENCE_NS = 1000000000;

/* The last Frames of a run that is over come within this, or not at all. */
static const uint64_t END_PATIENCE_NS = 1000000000;

/* Handlers that take long get so much at a time: the process has mail and heartbeats, too. */
static const uint64_t FRAMES_NS = 100000000;

/* That a simulator has left is no sample, and is looked for. */
static const int64_t ROUND_NS = 50000000;

enum { STEPS_NONE = -1 }; /* the step before the first */

struct mu_watch {
    mu_process *process; /* or NULL: */
    struct bus own;
    struct bus *bus;
    struct bus_reader scenes, frames, statuses;
    struct mu_watch_handlers handlers;
    struct watch_room *room;
    char simulator[MU_PROCESS_MAX + 1]; /* whose Scene was the last */
    enum watch_phase phase;
    bool announced;   /* the program that waits for it knows that it sees a run */
    uint64_t met_ns;  /* since when a simulator is here */
    int64_t step;     /* of the last Frame; STEPS_NONE */
    uint64_t time_ns; /* simulated, of that Frame */
    uint64_t missed;
    int64_t wait_ns; /* of the next spin; 0: Frames were left for that */
    uint64_t over_ns;
    enum mu_run_end end;
    int64_t last_step; /* of a run that is over */
    uint64_t last_time_ns, duration_ns;
    char hash[MU_FIELD_MAX + 2];
    char reason[MU_ATTRIBUTES_MAX + 1];
    volatile sig_atomic_t stopped;
    uint32_t forks; /* as in struct mu_process */
    bool spins;     /* in mu_watch_spin, and so in handlers */
};

static bool has_scene(const mu_watch *w)
{
    return w->phase == WATCH_SEEN || w->phase == WATCH_OVER_SEEN;
}

static bool is_over(const mu_watch *w)
{
    return w->phase >= WATCH_OVER_AWAY && w->phase <= WATCH_OVER_SEEN;
}

/* --- opening ---------------------------------------------------------------------------------- */

/* A simulator hears of them in this order: it sends Frames to a watch that has its Scene. */
static mu_result readers_open(mu_watch *w, bool latest)
{
    MU_TRY(latest
               ? bus_reader_open(w->bus, BUS_FRAME, "latest", &w->frames)
               : bus_reader_open_deep(w->bus, BUS_FRAME, "every", MU_WATCH_BEHIND_MAX, &w->frames));
    MU_TRY(bus_reader_open(w->bus, BUS_SCENE, NULL, &w->scenes));
    return bus_reader_open(w->bus, BUS_RUN_STATUS, NULL, &w->statuses);
}

static bool has_seen(const void *self, int64_t step)
{
    const mu_watch *w = self;
    return step == STEPS_NONE ? has_scene(w) : w->step >= step;
}

/* Agents that take part in steps act on the Frames that they have seen. */
static void steps_hold(mu_watch *w, bool latest)
{
    if (w->process && w->process->role == PROCESS_WATCH && w->process->steps < PROCESS_READY &&
        !latest) {
        process_see_first(w->process, has_seen, w);
    }
}

static void run_forget(mu_watch *w)
{
    w->step = STEPS_NONE;
    w->time_ns = w->missed = 0;
    w->simulator[0] = w->hash[0] = w->reason[0] = '\0';
}

static void bus_leave(mu_watch *w)
{
    if (!w->process) {
        bus_close(&w->own);
        return;
    }
    process_see_first(w->process, NULL, NULL);
    bus_reader_close(&w->scenes);
    bus_reader_close(&w->frames);
    bus_reader_close(&w->statuses);
}

static const struct built_struct structs[] = {
    {"mu_watch_options", sizeof(struct mu_watch_options), true},
    {"mu_outline", sizeof(struct mu_outline), false},
    {"mu_mount", sizeof(struct mu_mount), false},
    {"mu_figure", sizeof(struct mu_figure), false},
    {"mu_robot_view", sizeof(struct mu_robot_view), false},
    {"mu_object_view", sizeof(struct mu_object_view), false},
    {"mu_act_view", sizeof(struct mu_act_view), false},
    {"mu_mail", sizeof(struct mu_mail), false},
    {"mu_agent_view", sizeof(struct mu_agent_view), false},
    {"mu_scene", sizeof(struct mu_scene), false},
    {"mu_frame", sizeof(struct mu_frame), false},
    {"mu_run_result", sizeof(struct mu_run_result), true}};

mu_result(mu_watch_open)(mu_watch **out, mu_process *p, const struct mu_watch_options *options)
{
    return mu_watch_open(out, p, options);
}

mu_result mu_watch_open_built(mu_watch **out, mu_process *p, const struct mu_watch_options *options,
                              const char *version, const uint32_t *sizes)
{
    if (!built_fits(version, sizes, structs, sizeof structs / sizeof structs[0])) {
        return MU_FAULT_USAGE;
    }
    struct mu_watch_options own = {0};
    memcpy(&own, options, sizes[0]);
    options = &own;
    mu_watch *w = mu_startup_alloc(sizeof *w);
    w->forks = mu_forks();
    w->process = p;
    w->bus = p ? &p->bus : &w->own;
    w->handlers = options->handlers;
    w->room = watch_room_take();
    w->wait_ns = ROUND_NS;
    run_forget(w);
    if (!p) {
        struct bus_options bus = {.domain = options->domain,
                                  .place = BUS_OBSERVER,
                                  .name = "watch",
                                  .interface = options->interface,
                                  .hub = options->peer};
        MU_TRY(bus_open(&w->own, &bus));
    }
    mu_result opened = readers_open(w, options->latest);
    if (opened != MU_OK) {
        bus_leave(w);
        return opened;
    }
    steps_hold(w, options->latest);
    *out = w;
    return MU_OK;
}

/* --- what comes ------------------------------------------------------------------------------- */

static void simulator_met(mu_watch *w)
{
    enum watch_phase was = w->phase;
    watch_phase_on(&w->phase, WATCH_MEETS);
    w->met_ns = w->phase != was ? mu_clock_ns() : w->met_ns;
}

static void scene_take(mu_watch *w, const muster_Scene *s)
{
    run_forget(w);
    watch_phase_on(&w->phase, WATCH_SCENE);
    mu_text_copy(w->simulator, sizeof w->simulator, s->simulator);
    const struct mu_scene *scene = watch_scene(w->room, s);
    if (w->handlers.on_scene) {
        w->handlers.on_scene(w->handlers.self, scene);
    }
}

static void frame_take(mu_watch *w, const muster_Frame *f)
{
    bool ours = w->simulator[0] == '\0' || strcmp(f->simulator, w->simulator) == 0;
    if (!ours || f->step < 0 || (w->step >= 0 && f->step <= w->step)) {
        return;
    }
    struct mu_frame *frame = watch_frame(w->room, f);
    frame->missed = (uint64_t)f->step - (uint64_t)(w->step + 1);
    w->missed += frame->missed;
    w->step = f->step;
    w->time_ns = f->time_ns;
    if (w->handlers.on_step) {
        w->handlers.on_step(w->handlers.self, frame);
    }
}

static void status_take(mu_watch *w, const muster_RunStatus *s)
{
    bool over = s->state == muster_RUN_DONE || s->state == muster_RUN_FAULT;
    enum watch_phase was = w->phase;
    watch_phase_on(&w->phase, over ? WATCH_ENDS : WATCH_GOES_ON);
    if (!over || w->phase == was) {
        return;
    }
    w->over_ns = mu_clock_ns();
    w->end = s->state == muster_RUN_DONE ? MU_RUN_DONE : MU_RUN_FAULT;
    w->last_step = s->step;
    w->last_time_ns = s->time_ns;
    w->duration_ns = s->duration_ns;
    mu_text_copy(w->hash, sizeof w->hash, s->hash);
    (void)mu_text_copy(w->reason, sizeof w->reason, w->end == MU_RUN_FAULT ? s->waits_for : "");
}

/* The program that started this process may wait for the word that it sees the run. */
static void ready_tell(mu_watch *w)
{
    const char *name = getenv("MUSTER_READY");
    char *end = NULL;
    long fd = name ? strtol(name, &end, 10) : -1;
    w->announced = true;
    if (name && end != name && *end == '\0' && fd > STDERR_FILENO && fd <= INT_MAX) {
        ssize_t written = write((int)fd, "\n", 1);
        (void)written; /* it has given up */
    }
}

/* --- rounds ----------------------------------------------------------------------------------- */

static void scenes_look(mu_watch *w)
{
    enum bus_life life;
    const muster_Scene *s;
    while ((s = bus_next(&w->scenes, &life))) {
        if (life == BUS_DATA) {
            scene_take(w, s);
        }
    }
}

static void statuses_look(mu_watch *w)
{
    enum bus_life life;
    const muster_RunStatus *s;
    while ((s = bus_next(&w->statuses, &life))) {
        if (life == BUS_DATA) {
            status_take(w, s);
        }
    }
}

/* Frames wait for their Scene.  @param most_ns  no new one after so long */
static void frames_look(mu_watch *w, uint64_t most_ns)
{
    enum bus_life life;
    const muster_Frame *f = NULL;
    uint64_t began_ns = mu_clock_ns();
    bool patient = began_ns - w->met_ns < SCENE_PATIENCE_NS;
    if (!has_scene(w) && patient) {
        return;
    }
    do {
        f = bus_next(&w->frames, &life);
        if (f && life == BUS_DATA) {
            frame_take(w, f);
        }
    } while (f && mu_clock_ns() - began_ns < most_ns);
    w->wait_ns = f ? 0 : ROUND_NS;
}

static void end_tell(mu_watch *w)
{
    bool over = is_over(w);
    struct mu_run_result result = {.end = over ? w->end : MU_RUN_LOST,
                                   .step = over ? w->last_step : w->step,
                                   .time_ns = over ? w->last_time_ns : w->time_ns,
                                   .duration_ns = over ? w->duration_ns : 0,
                                   .hash = over ? w->hash : "none",
                                   .reason = over ? w->reason : "the simulator has gone"};
    watch_phase_on(&w->phase, WATCH_TELLS);
    if (w->handlers.on_end) {
        w->handlers.on_end(w->handlers.self, &result);
    }
    run_forget(w);
}

/* Its Scene may be here before the writer of its Frames is known, and is no end then. */
static bool simulator_is_here(const mu_watch *w)
{
    return bus_reader_matches(&w->frames) > 0 || bus_reader_matches(&w->scenes) > 0;
}

/* @return whether the program was told of an end */
static bool end_look(mu_watch *w)
{
    bool here = simulator_is_here(w);
    if (!here && w->phase != WATCH_AWAY) {
        statuses_look(w); /* its last status came while the Frames were looked at */
    }
    bool whole = is_over(w) && w->step >= w->last_step;
    bool late = is_over(w) && mu_clock_ns() - w->over_ns > END_PATIENCE_NS;
    bool tells = watch_may_tell(w->phase) && (whole || late || !here);
    if (tells) {
        frames_look(w, UINT64_MAX);
        end_tell(w);
    } else if (!here) {
        watch_phase_on(&w->phase, WATCH_LEAVES);
    }
    return tells;
}

/* @return whether the simulator knows of this process, if its steps are to wait for it */
static bool is_awaited(const mu_watch *w)
{
    return !w->process || !w->process->sees || w->process->steps != PROCESS_FREE;
}

static mu_result spin(mu_watch *w, int64_t timeout_ns)
{
    int64_t most_ns = timeout_ns < w->wait_ns ? timeout_ns : w->wait_ns;
    if (w->process) {
        MU_TRY(mu_process_spin(w->process, most_ns));
    } else {
        bus_wait(w->bus, 1, most_ns);
    }
    if (bus_reader_matches(&w->frames) > 0) {
        simulator_met(w);
    }
    scenes_look(w); /* before how its run goes */
    if (has_scene(w) && !w->announced && is_awaited(w)) {
        ready_tell(w);
    }
    statuses_look(w);
    frames_look(w, FRAMES_NS);
    if (w->process && w->process->sees) {
        w->process->spins = true;
        process_turn(w->process); /* a step may have waited for these Frames */
        w->process->spins = false;
    }
    return end_look(w) ? MU_DONE : MU_OK;
}

mu_result mu_watch_spin(mu_watch *w, int64_t timeout_ns)
{
    if (w->spins) {
        return MU_BUSY;
    }
    if (w->forks != mu_forks()) {
        return MU_FAULT_USAGE;
    }
    w->spins = true;
    mu_result spun = spin(w, timeout_ns);
    w->spins = false;
    return spun;
}

/* --- alone ------------------------------------------------------------------------------------ */

mu_result mu_watch_run(mu_watch *w)
{
    mu_signals_note();
    mu_result spun = MU_OK;
    while (spun == MU_OK && !w->stopped && !mu_signal_came) {
        spun = mu_watch_spin(w, ROUND_NS);
    }
    return spun < 0 || spun == MU_BUSY ? spun : MU_OK;
}

void mu_watch_stop(mu_watch *w)
{
    w->stopped = 1;
}

uint64_t mu_watch_missed(const mu_watch *w)
{
    return w->missed;
}

uint64_t mu_watch_refused(const mu_watch *w)
{
    return w->bus->malformed;
}

int mu_watch_wake_fd(mu_watch *w)
{
    return bus_wake_fd(w->bus);
}

void mu_watch_close(mu_watch *w)
{
    if (w && w->forks == mu_forks()) { /* what DDS runs in is not copied by fork */
        MU_ASSERT(!w->spins);
        bus_leave(w);
    }
}
