/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file stats.h
 * Statistics of a run so far, from its Scene and its Frames: the same figures as in a report.
 *
 * Nothing here reads a clock, a file or the network.  A program that takes in every Frame has the
 * exact figures of summary.json.  A program that misses some has the totals that Frames carry. Then
 * the explored part takes a straight line between two Frames, and nearest approaches, arrivals and
 * mail by performative count only the Frames that came.
 */
#ifndef MUSTER_STATS_H
#define MUSTER_STATS_H

#include "muster/monitor.h"

#pragma GCC visibility push(default)
#ifdef __cplusplus
extern "C" {
/* Some functions have the name of the struct that they return, which hides its constructor. */
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wshadow"
#endif

/* One robot; shares are 0 to 1.  A version adds members at the end. */
struct mu_stats_robot {
    char name[MU_NAME_MAX + 1];
    enum mu_state state;
    double x_m, y_m, heading_rad, speed_m_s;
    bool stalled, controlled;
    double distance_m, mean_speed_m_s, stalled_s;
    uint32_t stalls;
    uint64_t mails_sent, mails_received, firings;
    double efficiency_m_s; /* metres per second that it was not stalled */
    double explored;       /* share of the floor that its centre crossed; < 0: no Scene */
    double nearest_m;      /* how near another robot's centre has come; < 0: none has */
    double nearest_s;      /* when that was, simulated */
    size_t nearest;        /* which one */
    bool has_goal, there;  /* there: it has been at its goal since that was set */
    double goal_x_m, goal_y_m;
    double goal_s; /* how long it took there; until it is there, how long it has been on its way */
};

/* One agent without a body, of those that the run began with; likewise. */
struct mu_stats_agent {
    char name[MU_NAME_MAX + 1];
    enum mu_state state;
    uint64_t mails_sent, mails_received, firings;
};

/* All of them. */
struct mu_stats_team {
    int64_t step; /* of the last Frame; -1: none yet */
    double time_s, wall_s;
    double explored;            /* share of the floor that any robot's centre crossed; < 0: no
                                   Scene, or a world that is empty or too large */
    const char *most_efficient; /* by efficiency_m_s; NULL: no robot moved */
    double efficiency_m_s;      /* of that one */
    double distance_m;          /* these are sums */
    uint64_t stalls;
    uint64_t mails_sent, mails_received, firings; /* of agents without a body, too */
    uint64_t mails_outside;                       /* seen, from outside the run */
    uint64_t missed;                              /* steps that were not seen */
    uint64_t pairs_refused;                       /* approaches for which there was no room */
};

/* How near two robots have come to each other, centre to centre. */
struct mu_stats_pair {
    size_t one, other; /* one < other, in the order of the Scene */
    double near_m, time_s;
};

typedef struct mu_stats mu_stats;

/**
 * Takes the memory for worlds of any size that a Scene can have.
 *
 * @return NULL: the program was built with headers of another version that do not fit this library
 */
mu_stats *mu_stats_open(void);

/** What mu_stats_open is in C and C++, as mu_process_open_built.  @param sizes  mu_stats_sizes */
mu_stats *mu_stats_open_built(const char *version, const uint32_t *sizes);

/** Begins anew, with another run.  @param scene  NULL: it is not known */
void mu_stats_begin(mu_stats *s, const struct mu_scene *scene);

/** Takes in one more Frame; the steps behind the last one, each once. */
void mu_stats_take(mu_stats *s, const struct mu_frame *frame);

/**
 * Sets the place that a robot is to reach; the time to it counts from the last Frame on.  A goal of
 * rules, (goal WORD X Y) in mm, is seen where a robot keeps an execution trace, and replaces it.
 *
 * @param near_m  it is there when its centre is so near
 * @return MU_OK; MU_ABSENT: there is no such robot; MU_MALFORMED: not finite
 */
MU_MUST_USE mu_result mu_stats_goal(mu_stats *s, const char *robot, double x_m, double y_m,
                                    double near_m);

/** @return how many robots there are */
size_t mu_stats_count(const mu_stats *s);

/** @return the index-th robot in the order of the Scene; good until the next call of a function
 *          that changes s */
const struct mu_stats_robot *mu_stats_robot(const mu_stats *s, size_t index);

/** @return how many agents without a body the last Frame had */
size_t mu_stats_agent_count(const mu_stats *s);

/** @return the index-th agent without a body, in the order of the run, or NULL; good until the next
 *          call of a function that changes s */
const struct mu_stats_agent *mu_stats_agent(const mu_stats *s, size_t index);

/** @return all robots and agents together */
struct mu_stats_team mu_stats_team(const mu_stats *s);

/**
 * Mail that the run's agents were seen to send, by performative in the order of first appearance.
 *
 * @param count  out: how many
 * @return the index-th performative, "" for none; "*" for those beyond MU_STATS_PERFORMATIVES;
 *         NULL past the last
 */
const char *mu_stats_performative(const mu_stats *s, size_t index, uint64_t *count);

/**
 * Nearest approaches, in no order.  Up to MU_STATS_ALL_PAIRS robots every pair has one; of more,
 * those that have come within MU_STATS_NEAR_M.
 *
 * @return whether there is an index-th
 */
bool mu_stats_pair(const mu_stats *s, size_t index, struct mu_stats_pair *pair);

/**
 * The most efficient robot has the highest of these figures.
 *
 * @param step_s  the length of a step, the shortest time that counts
 * @return metres per second that a robot was not stalled; 0: it was stalled for more than half of
 *         the time
 */
double mu_stats_efficiency(double distance_m, double time_s, double stalled_s, double step_s);

/* As mu_process_sizes. */
static inline const uint32_t *mu_stats_sizes(void)
{
    static const uint32_t sizes[] = {
        (uint32_t)sizeof(struct mu_stats_robot), (uint32_t)sizeof(struct mu_stats_agent),
        (uint32_t)sizeof(struct mu_stats_team), (uint32_t)sizeof(struct mu_stats_pair), 0};
    return sizes;
}

#define mu_stats_open() mu_stats_open_built(MU_VERSION, mu_stats_sizes())

#ifdef __cplusplus
#pragma GCC diagnostic pop
}
#endif
#pragma GCC visibility pop

#endif
