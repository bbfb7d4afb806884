/* SPDX-License-Identifier: Apache-2.0 */
/* What an experiment has of a name. */
#include "experiment/experiment_source.h"

#include <string.h>

const struct experiment_robot *experiment_find_robot(const struct experiment *e, const char *name)
{
    for (unsigned i = 0; i < experiment_members(e); i++) {
        if (strcmp(e->robots[i].name, name) == 0) {
            return &e->robots[i];
        }
    }
    return NULL;
}

/* @return the index of a host, or how many there are */
unsigned experiment_find_host(const struct experiment *e, const char *name)
{
    unsigned i = 0;
    while (i < e->hosts_count && strcmp(e->hosts[i], name) != 0) {
        i++;
    }
    return i;
}

bool experiment_is_resolver(const struct experiment *e, const char *part)
{
    size_t prefix = sizeof EXPERIMENT_RESOLVER - 1;
    bool found = false;
    for (unsigned i = 0; i < e->resolvers_count && !found; i++) {
        found = strncmp(part, EXPERIMENT_RESOLVER, prefix) == 0 &&
                strcmp(part + prefix, e->resolvers[i]) == 0;
    }
    return found;
}

/* @return the index of a broker, or how many there are */
unsigned experiment_find_broker(const struct experiment *e, const char *name)
{
    unsigned i = 0;
    while (i < e->brokers_count && strcmp(e->brokers[i], name) != 0) {
        i++;
    }
    return i;
}

int experiment_robot_find(const struct experiment *e, const char *name)
{
    const struct experiment_robot *robot = experiment_find_robot(e, name);
    return robot ? (int)(robot - e->robots) : -1;
}

int experiment_agent_find(const void *experiment, const char *name)
{
    const struct experiment *e = experiment;
    int index = experiment_robot_find(e, name);
    return index >= (int)e->robots_count ? index - (int)e->robots_count : -1;
}

/* Things are known when the world is, which the run checks. */
int experiment_body_find(const void *experiment, const char *name)
{
    const struct experiment *e = experiment;
    int robot = experiment_robot_find(e, name);
    return robot >= 0 ? robot : (int)experiment_members(e);
}

static const char *const statistic_names[STATISTICS] = {
    [STATISTIC_DISTANCE] = "distance_m",
    [STATISTIC_STALLS] = "stalls",
    [STATISTIC_STALLED] = "stalled_s",
    [STATISTIC_MEAN_SPEED] = "mean_speed_m_s",
    [STATISTIC_MAIL_SENT] = "mail_sent",
    [STATISTIC_MAIL_RECEIVED] = "mail_received",
    [STATISTIC_RULE_FIRINGS] = "rule_firings",
    [STATISTIC_FINAL_X] = "final.x_m",
    [STATISTIC_FINAL_Y] = "final.y_m",
    [STATISTIC_FINAL_HEADING] = "final.heading_rad",
    [STATISTIC_SIM_TIME] = "sim_time_s",
    [STATISTIC_WALL_TIME] = "wall_time_s",
    [STATISTIC_REAL_TIME_FACTOR] = "real_time_factor",
    [STATISTIC_EXPLORED] = "explored_fraction",
    [STATISTIC_SENT] = "mail.sent",
    [STATISTIC_DELIVERED] = "mail.delivered",
    [STATISTIC_WAITING] = "mail.waiting",
    [STATISTIC_EXPIRED] = "mail.expired",
    [STATISTIC_REFUSED] = "mail.refused",
    [STATISTIC_LOST] = "mail.lost",
    [STATISTIC_DUPLICATED] = "mail.duplicated",
};

/* @return the statistic of that name from first on, before last; STATISTICS: none */
static enum experiment_statistic statistic_among(const char *name, unsigned first, unsigned last)
{
    for (unsigned i = first; i < last; i++) {
        if (strcmp(statistic_names[i], name) == 0) {
            return (enum experiment_statistic)i;
        }
    }
    return STATISTICS;
}

/* @return whether the statistic is one of a robot, or of an agent without a body */
static bool statistic_is_had(const struct experiment *e, unsigned index,
                             enum experiment_statistic statistic)
{
    bool of_mind = statistic >= STATISTIC_MAIL_SENT && statistic <= STATISTIC_RULE_FIRINGS;
    return statistic != STATISTICS && (index < e->robots_count || of_mind);
}

/* @return what stands behind NAME. in a statistic's name, or NULL */
static const char *statistic_behind(const char *text, const char *name)
{
    size_t len = strlen(name);
    return strncmp(text, name, len) == 0 && text[len] == '.' ? text + len + 1 : NULL;
}

enum experiment_statistic experiment_statistic_find(const struct experiment *e, const char *name,
                                                    int *robot)
{
    enum experiment_statistic found = statistic_among(name, STATISTIC_SIM_TIME, STATISTICS);
    const char *rest = statistic_behind(name, "robots");
    *robot = rest ? EXPERIMENT_ALL_ROBOTS : EXPERIMENT_NO_ROBOT;
    for (unsigned i = 0; found == STATISTICS && !rest && i < experiment_members(e); i++) {
        const char *behind = statistic_behind(name, e->robots[i].name);
        bool known =
            behind && statistic_is_had(e, i, statistic_among(behind, 0, STATISTIC_SIM_TIME));
        rest = known ? behind : NULL; /* names have dots, too */
        *robot = known ? (int)i : *robot;
    }
    return found == STATISTICS && rest ? statistic_among(rest, 0, STATISTIC_SIM_TIME) : found;
}

unsigned experiment_event_find(const struct experiment *e, const char *text)
{
    for (unsigned i = 0; i < e->events_count; i++) {
        if (strcmp(e->events[i], text) == 0) {
            return i;
        }
    }
    return EXPERIMENT_EVENTS_MAX;
}
