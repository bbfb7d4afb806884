/* SPDX-License-Identifier: Apache-2.0 */
#include "muster/stats.h"

#include "core/built.h"
#include "core/rounded.h"
#include "core/text.h"
#include "muster/memory.h"
#include "stats/stats.h"

#include <math.h>
#include <string.h>

/* How far from a goal of the rules a robot is there: a little more than (gohome) itself wants. */
static const double GOAL_NEAR_M = 0.2;

/* What is kept of a robot beside its figures. */
struct stats_robot {
    bool seen;
    double first_s;
    double x_m, y_m;   /* as in run.csv */
    double goal_set_s; /* when its goal was set */
    double goal_near_m;
};

struct stats_word {
    char text[MU_FIELD_MAX + 1];
    uint64_t count;
};

struct mu_stats {
    struct explored *explored;
    struct approach *approach;
    struct approach_place places[MU_ROBOTS_MAX];
    bool floor; /* there is one to explore */
    size_t count;
    struct mu_stats_robot robots[MU_ROBOTS_MAX];
    struct stats_robot own[MU_ROBOTS_MAX];
    size_t agent_count;
    struct mu_stats_agent agents[MU_AGENTS_MAX];
    struct stats_word words[MU_STATS_PERFORMATIVES + 1];
    size_t word_count;
    double step_s, time_s, wall_s;
    int64_t step;
    uint64_t missed, outside;
};

double mu_stats_efficiency(double distance_m, double time_s, double stalled_s, double step_s)
{
    return stalled_s > time_s / 2 ? 0 : distance_m / fmax(time_s - stalled_s, step_s);
}

static const struct built_struct structs[] = {
    {"mu_stats_robot", sizeof(struct mu_stats_robot), true},
    {"mu_stats_agent", sizeof(struct mu_stats_agent), true},
    {"mu_stats_team", sizeof(struct mu_stats_team), false},
    {"mu_stats_pair", sizeof(struct mu_stats_pair), false}};

mu_stats *(mu_stats_open)(void)
{
    return mu_stats_open();
}

mu_stats *mu_stats_open_built(const char *version, const uint32_t *sizes)
{
    if (!built_fits(version, sizes, structs, sizeof structs / sizeof structs[0])) {
        return NULL;
    }
    mu_stats *s = mu_startup_alloc(sizeof *s);
    s->explored = explored_reserve(MU_ROBOTS_MAX);
    s->approach = approach_reserve();
    mu_stats_begin(s, NULL);
    return s;
}

static void stats_clear(mu_stats *s, size_t robots)
{
    memset(s->robots, 0, sizeof s->robots);
    memset(s->own, 0, sizeof s->own);
    memset(s->words, 0, sizeof s->words);
    s->count = robots < MU_ROBOTS_MAX ? robots : MU_ROBOTS_MAX;
    s->word_count = s->agent_count = 0;
    s->step = -1;
    s->time_s = s->wall_s = 0;
    s->missed = s->outside = 0;
    approach_begin(s->approach, s->count);
}

/* scene NULL: there is none. */
void mu_stats_begin(mu_stats *s, const struct mu_scene *scene)
{
    stats_clear(s, scene ? scene->robot_count : 0);
    s->floor = scene && explored_begin(s->explored, scene);
    s->step_s = (double)(scene ? scene->step_ns : MU_STEP_NS) * 1e-9;
    for (size_t i = 0; i < s->count; i++) {
        struct mu_stats_robot *r = &s->robots[i];
        mu_text_copy(r->name, sizeof r->name, scene->robots[i].name);
        r->controlled = scene->robots[i].controlled;
        r->explored = s->floor ? 0 : -1;
        r->nearest_m = -1;
        r->state = MU_GONE;
    }
}

/* --- a Frame ---------------------------------------------------------------------------------- */

/* A user without a Scene knows names from the Frames alone. */
static void robots_learn(mu_stats *s, const struct mu_frame *f)
{
    stats_clear(s, f->robot_count);
    s->floor = false;
    for (size_t i = 0; i < s->count; i++) {
        struct mu_stats_robot *r = &s->robots[i];
        mu_text_copy(r->name, sizeof r->name, f->robots[i].name);
        r->controlled = f->robots[i].state != MU_GONE;
        r->explored = r->nearest_m = -1;
    }
}

static void floor_take(mu_stats *s, size_t i, double x_m, double y_m, bool placed)
{
    struct stats_robot *own = &s->own[i];
    bool drove = own->seen && !placed;
    if (s->floor && s->robots[i].controlled) {
        double from_x_m = drove ? own->x_m : x_m, from_y_m = drove ? own->y_m : y_m;
        explored_cross(s->explored, i, from_x_m, from_y_m, x_m, y_m);
    }
    own->x_m = x_m;
    own->y_m = y_m;
}

static void goal_take(struct mu_stats_robot *r, const struct stats_robot *own, double time_s)
{
    if (!r->has_goal || r->there) {
        return;
    }
    r->goal_s = time_s - own->goal_set_s;
    r->there = hypot(r->x_m - r->goal_x_m, r->y_m - r->goal_y_m) <= own->goal_near_m;
}

static void robot_take(mu_stats *s, size_t i, const struct mu_robot_view *v)
{
    struct mu_stats_robot *r = &s->robots[i];
    struct stats_robot *own = &s->own[i];
    r->state = v->state;
    r->x_m = v->x_m;
    r->y_m = v->y_m;
    r->heading_rad = v->heading_rad;
    r->speed_m_s = v->forward_m_s;
    r->stalled = v->stalled;
    r->distance_m = v->distance_m;
    r->stalled_s = v->stalled_s;
    r->stalls = v->stalls;
    r->mails_sent = v->mails_sent;
    r->mails_received = v->mails_received;
    r->firings = v->firings;
    r->mean_speed_m_s = s->time_s > 0 ? r->distance_m / s->time_s : 0;
    r->efficiency_m_s = mu_stats_efficiency(r->distance_m, s->time_s, r->stalled_s, s->step_s);
    s->places[i] = (struct approach_place){v->x_m, v->y_m};
    goal_take(r, own, s->time_s);
    floor_take(s, i, mu_rounded(v->x_m), mu_rounded(v->y_m), v->placed);
    own->seen = true;
}

static void agents_take(mu_stats *s, const struct mu_frame *f)
{
    s->agent_count = f->agent_count < MU_AGENTS_MAX ? f->agent_count : MU_AGENTS_MAX;
    for (size_t i = 0; i < s->agent_count; i++) {
        const struct mu_agent_view *v = &f->agents[i];
        struct mu_stats_agent *a = &s->agents[i];
        mu_text_copy(a->name, sizeof a->name, v->name);
        a->state = v->state;
        a->mails_sent = v->mails_sent;
        a->mails_received = v->mails_received;
        a->firings = v->firings;
    }
}

/* What changes whenever another robot moves, too. */
static void shares_take(mu_stats *s)
{
    for (size_t i = 0; i < s->count; i++) {
        struct mu_stats_robot *r = &s->robots[i];
        r->explored = s->floor ? explored_share_of(s->explored, i) : -1;
        const struct mu_stats_pair *p = approach_of(s->approach, i);
        if (p) {
            r->nearest_m = p->near_m;
            r->nearest_s = p->time_s;
            r->nearest = p->one == i ? p->other : p->one;
        }
    }
}

static struct stats_word *word_find(mu_stats *s, const char *text)
{
    for (size_t i = 0; i < s->word_count; i++) {
        if (strcmp(s->words[i].text, text) == 0) {
            return &s->words[i];
        }
    }
    bool full = s->word_count == MU_STATS_PERFORMATIVES;
    struct stats_word *w = &s->words[full ? MU_STATS_PERFORMATIVES : s->word_count++];
    mu_text_copy(w->text, sizeof w->text, full ? "*" : text);
    return w;
}

/* @param from  where to look first: acts come in the order of the robots */
static size_t robot_find(const mu_stats *s, const char *name, size_t from)
{
    for (size_t k = 0; k < s->count; k++) {
        size_t i = (from + k) % s->count;
        if (strcmp(s->robots[i].name, name) == 0) {
            return i;
        }
    }
    return s->count;
}

static void goal_set(mu_stats *s, size_t i, double x_m, double y_m, double near_m)
{
    struct mu_stats_robot *r = &s->robots[i];
    r->has_goal = true;
    r->there = false;
    r->goal_x_m = x_m;
    r->goal_y_m = y_m;
    r->goal_s = 0;
    s->own[i].goal_set_s = s->time_s;
    s->own[i].goal_near_m = near_m;
}

static void act_take(mu_stats *s, const struct mu_act_view *act, size_t *robot)
{
    double x_m, y_m;
    for (size_t i = 0; i < act->mail_count; i++) {
        word_find(s, act->mails[i].performative)->count++;
    }
    if (act->diary[0] && goal_in_diary(act->diary, &x_m, &y_m)) {
        *robot = robot_find(s, act->agent, *robot);
        if (*robot < s->count) {
            goal_set(s, *robot, x_m, y_m, GOAL_NEAR_M);
        }
    }
}

void mu_stats_take(mu_stats *s, const struct mu_frame *f)
{
    if (s->step < 0 && s->count == 0) {
        robots_learn(s, f);
    }
    if (f->step <= s->step || f->robot_count != s->count) {
        return; /* of another run, or had before */
    }
    s->step = f->step;
    s->time_s = mu_rounded((double)f->time_ns * 1e-9);
    s->wall_s = (double)f->wall_ns * 1e-9;
    s->missed += f->missed;
    for (size_t i = 0; i < s->count; i++) {
        robot_take(s, i, &f->robots[i]);
    }
    agents_take(s, f);
    approach_take(s->approach, s->places, s->time_s);
    shares_take(s);
    size_t robot = 0;
    for (size_t i = 0; i < f->act_count; i++) {
        act_take(s, &f->acts[i], &robot);
    }
    s->outside += f->outside_count;
}

mu_result mu_stats_goal(mu_stats *s, const char *robot, double x_m, double y_m, double near_m)
{
    if (!isfinite(x_m) || !isfinite(y_m) || !isfinite(near_m)) {
        return MU_MALFORMED;
    }
    size_t i = robot_find(s, robot, 0);
    if (i == s->count) {
        return MU_ABSENT;
    }
    goal_set(s, i, x_m, y_m, near_m);
    return MU_OK;
}

/* --- what was asked for ----------------------------------------------------------------------- */

size_t mu_stats_count(const mu_stats *s)
{
    return s->count;
}

const struct mu_stats_robot *mu_stats_robot(const mu_stats *s, size_t index)
{
    return index < s->count ? &s->robots[index] : NULL;
}

size_t mu_stats_agent_count(const mu_stats *s)
{
    return s->agent_count;
}

const struct mu_stats_agent *mu_stats_agent(const mu_stats *s, size_t index)
{
    return index < s->agent_count ? &s->agents[index] : NULL;
}

struct mu_stats_team mu_stats_team(const mu_stats *s)
{
    struct mu_stats_team t = {.step = s->step,
                              .time_s = s->time_s,
                              .wall_s = s->wall_s,
                              .explored = s->floor ? explored_share(s->explored) : -1,
                              .mails_outside = s->outside,
                              .missed = s->missed,
                              .pairs_refused = approach_refused(s->approach)};
    double best_m_s = 0;
    for (size_t i = 0; i < s->count; i++) {
        const struct mu_stats_robot *r = &s->robots[i];
        t.distance_m += r->distance_m;
        t.stalls += r->stalls;
        t.mails_sent += r->mails_sent;
        t.mails_received += r->mails_received;
        t.firings += r->firings;
        if (r->controlled && r->efficiency_m_s > best_m_s) {
            best_m_s = r->efficiency_m_s;
            t.most_efficient = r->name;
            t.efficiency_m_s = best_m_s;
        }
    }
    for (size_t i = 0; i < s->agent_count; i++) {
        t.mails_sent += s->agents[i].mails_sent;
        t.mails_received += s->agents[i].mails_received;
        t.firings += s->agents[i].firings;
    }
    return t;
}

const char *mu_stats_performative(const mu_stats *s, size_t index, uint64_t *count)
{
    const struct stats_word *w = &s->words[MU_STATS_PERFORMATIVES];
    if (index < s->word_count) {
        w = &s->words[index];
    } else if (index > s->word_count || w->count == 0) {
        return NULL;
    }
    *count = w->count;
    return w->text;
}

bool mu_stats_pair(const mu_stats *s, size_t index, struct mu_stats_pair *pair)
{
    const struct mu_stats_pair *p = approach_pair(s->approach, index);
    if (p) {
        *pair = *p;
    }
    return p != NULL;
}
