/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file monitor.h
 * Looking at a run: its Scene once, and then Frames, each a step as a whole.
 *
 * A watch only reads.  No process waits for it: with it and without it a run has the same hash.  A
 * program that is slower than the run misses steps, and is told how many.  An agent that asks
 * robots by mail may live in the same process (mu_agent_join); its mails are in the hash.  If that
 * process watches (mu_process_options), and the agent is of MU_KIND_SPECIAL, a lock step waits for
 * it: mail that it sends in on_step goes out with the step after that.
 *
 * Units: metres, radians (counter-clockwise, 0 along +x), seconds, or nanoseconds where the name
 * says so.
 */
#ifndef MUSTER_MONITOR_H
#define MUSTER_MONITOR_H

#include "muster/agent.h"

#pragma GCC visibility push(default)
#ifdef __cplusplus
extern "C" {
#endif

/* A convex piece, seen from above. */
struct mu_outline {
    uint32_t rgb;    /* 0xRRGGBB */
    bool flat;       /* a mark on the floor: nothing stops at it, nothing echoes */
    double radius_m; /* of a disc about its only corner; 0: corners say it */
    size_t corner_count;
    const float *corners_m; /* x, y, x, y, ..., counter-clockwise */
};

/* The place of a sensor on a body, and what it covers. */
struct mu_mount {
    double x_m, y_m, heading_rad; /* in the body's frame */
    double fov_rad;               /* about its heading, half to each side */
    double range_m;
    uint32_t beams; /* of a laser; columns of a camera's picture; 1 of a sonar or fiducial finder */
};

/* The constant data of a robot, or of a thing that can be moved. */
struct mu_figure {
    const char *name;
    const char *color;            /* CSS, or #rrggbb */
    struct mu_outline shape;      /* in its own frame */
    double x_m, y_m, heading_rad; /* where it starts */
    bool controlled;              /* a robot that the run has a controller for */
    size_t sonar_count;
    const struct mu_mount *sonars; /* in the order of mu_percept.sonar_m */
    const struct mu_mount *laser, *camera, *fiducial_finder; /* NULL: it has none */
};

struct mu_scene {
    const char *simulator, *world; /* the world's file, without the folder */
    uint64_t seed, step_ns;        /* step_ns: simulated time of one step */
    double min_x_m, min_y_m, max_x_m, max_y_m;
    size_t wall_count, robot_count, object_count;
    const struct mu_outline *walls;
    const struct mu_figure *robots; /* in the order of every Frame */
    const struct mu_figure *objects;
};

/* A robot at the beginning of a step, and its totals since the start. */
struct mu_robot_view {
    const char *name;
    enum mu_state state;
    double x_m, y_m, heading_rad;   /* where it truly is */
    double forward_m_s, turn_rad_s; /* how it moves */
    double command_forward_m_s, command_turn_rad_s;
    const char *goal; /* its goal, as it said last: "gohome 3000.0 0.0"; "": it does not say */
    bool stalled;
    bool fault;  /* the simulator had to put it back */
    bool placed; /* it did not drive here: it was put here in the step before */
    double distance_m, stalled_s;
    uint32_t stalls; /* how often it began to be stalled */
    uint64_t firings, mails_sent, mails_received;
};

/* An agent without a body, and its totals since the start. */
struct mu_agent_view {
    const char *name;
    enum mu_state state;
    uint64_t firings, mails_sent, mails_received;
};

struct mu_object_view {
    const char *name;
    double x_m, y_m, heading_rad;
};

/* The actions of an agent in a step. */
struct mu_act_view {
    const char *agent;
    enum mu_state state;
    uint32_t firings;
    const char *rules; /* names of those that fired, in order, between spaces */
    size_t mail_count;
    const struct mu_mail *mails;
    const char *diary; /* its execution trace; "" unless it keeps one */
};

struct mu_frame {
    int64_t step;
    uint64_t time_ns; /* simulated, at the beginning of the step */
    uint64_t wall_ns; /* since the first step */
    uint64_t digest;  /* how the run's hash would begin if it ended here; 0: it has none */
    uint64_t missed;  /* steps that this watch has not seen since the Frame before, or the start */
    uint64_t cut;     /* mails of this step that there was no room for */
    size_t robot_count, object_count, act_count, outside_count;
    const struct mu_robot_view *robots;
    const struct mu_object_view *objects;
    const struct mu_act_view *acts;
    const struct mu_mail *outside; /* mails from outside the run, taken in this step */
    size_t agent_count;
    const struct mu_agent_view *agents; /* those that the run began with, in its order */
};

/* How a run ended. */
enum mu_run_end {
    MU_RUN_DONE,
    MU_RUN_FAULT, /* it broke off; the reason is what failed */
    MU_RUN_LOST   /* its simulator has gone without a word */
};

/* A version adds members at the end. */
struct mu_run_result {
    enum mu_run_end end;
    int64_t step;
    uint64_t time_ns;     /* simulated, */
    uint64_t duration_ns; /* of so much that was planned; 0: it is not known */
    const char *hash;     /* 64 hexadecimal digits, or "none" */
    const char *reason;   /* "" when done */
};

/* Events of a watch; any handler may be NULL.  Arguments are valid in the handler only. */
struct mu_watch_handlers {
    void *self;
    /** A run is there: again with each run that begins after another one's end. */
    void (*on_scene)(void *self, const struct mu_scene *scene);
    void (*on_step)(void *self, const struct mu_frame *frame);
    void (*on_end)(void *self, const struct mu_run_result *result);
};

/* A version adds members at the end, handlers among them: all 0 is as before. */
struct mu_watch_options {
    int domain;            /* DDS domain; these three only where there is no process */
    const char *interface; /* address of the interface; NULL: 127.0.0.1 */
    const char *peer;      /* hosts of the simulator, joined by commas; NULL: this one */
    bool latest;           /* one Frame every 40 ms at most, for a display; else every step */
    struct mu_watch_handlers handlers;
};

typedef struct mu_watch mu_watch;

/**
 * Begins to watch the domain; the run may be there already, or come later.
 *
 * @param p  a process whose agents live beside the watch, and which mu_watch_spin spins; NULL: none
 * @return MU_OK; MU_FAULT_USAGE: an option is wrong, or there is no process and the program is in
 *         that domain already, or was built with headers that do not fit; MU_FAULT_DDS
 */
MU_MUST_USE mu_result mu_watch_open(mu_watch **out, mu_process *p,
                                    const struct mu_watch_options *options);

/** What mu_watch_open is in C and C++, as mu_process_open_built.  @param sizes  mu_watch_sizes */
MU_MUST_USE mu_result mu_watch_open_built(mu_watch **out, mu_process *p,
                                          const struct mu_watch_options *options,
                                          const char *version, const uint32_t *sizes);

/**
 * Waits for at most timeout_ns and hands out samples that have arrived.
 *
 * @return MU_OK; MU_DONE: a run has ended, and on_end was called; it may be called again, for the
 *         next run; MU_BUSY: a handler of this watch called it; MU_FAULT_USAGE: in a child of the
 *         program that opened it
 */
MU_MUST_USE mu_result mu_watch_spin(mu_watch *w, int64_t timeout_ns);

/**
 * Spins until a run has ended, mu_watch_stop is called, or SIGINT or SIGTERM arrives.
 *
 * @return MU_OK: it has ended, for whatever reason; otherwise as mu_watch_spin
 */
MU_MUST_USE mu_result mu_watch_run(mu_watch *w);

/** Ends mu_watch_run; may be called from handlers and signal handlers. */
void mu_watch_stop(mu_watch *w);

/** @return how many steps of this run it has not seen, from the first one to its last Frame */
uint64_t mu_watch_missed(const mu_watch *w);

/** @return samples that were no Scene, Frame or RunStatus, and were refused */
uint64_t mu_watch_refused(const mu_watch *w);

/** @return as mu_process_wake_fd: readable when there is something for mu_watch_spin(w, 0) */
int mu_watch_wake_fd(mu_watch *w);

/** Ends the watch; its process stays.  Not for handlers.  NULL, or in a child of the program that
 *  opened it: nothing to do. */
void mu_watch_close(mu_watch *w);

/* As mu_process_sizes. */
static inline const uint32_t *mu_watch_sizes(void)
{
    static const uint32_t sizes[] = {(uint32_t)sizeof(struct mu_watch_options),
                                     (uint32_t)sizeof(struct mu_outline),
                                     (uint32_t)sizeof(struct mu_mount),
                                     (uint32_t)sizeof(struct mu_figure),
                                     (uint32_t)sizeof(struct mu_robot_view),
                                     (uint32_t)sizeof(struct mu_object_view),
                                     (uint32_t)sizeof(struct mu_act_view),
                                     (uint32_t)sizeof(struct mu_mail),
                                     (uint32_t)sizeof(struct mu_agent_view),
                                     (uint32_t)sizeof(struct mu_scene),
                                     (uint32_t)sizeof(struct mu_frame),
                                     (uint32_t)sizeof(struct mu_run_result),
                                     0};
    return sizes;
}

#define mu_watch_open(...) mu_watch_open_built(__VA_ARGS__, MU_VERSION, mu_watch_sizes())

#ifdef __cplusplus
}
#endif
#pragma GCC visibility pop

#endif
