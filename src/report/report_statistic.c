/* SPDX-License-Identifier: Apache-2.0 */
/* The numbers of summary.json by name. */
#include "report/report_data.h"

#include <math.h>
#include <string.h>

/* What its mind did. */
static double of_agent(const struct report_robot *agent, enum experiment_statistic statistic)
{
    return (double)(statistic == STATISTIC_MAIL_SENT       ? agent->mail_sent
                    : statistic == STATISTIC_MAIL_RECEIVED ? agent->mail_received
                                                           : agent->rule_firings);
}

/* run.csv has the robots in the order of the world, the experiment in its own. */
static double of_robot(const struct report_data *data, enum experiment_statistic statistic,
                       size_t index)
{
    const struct report_robot *robot = &data->input->robots[index];
    const struct report_robot_result *result = &data->result->robots[index];
    if (statistic >= STATISTIC_MAIL_SENT && statistic <= STATISTIC_RULE_FIRINGS) {
        return of_agent(robot, statistic);
    }
    const double values[STATISTIC_SIM_TIME] = {
        [STATISTIC_DISTANCE] = result->distance_m,
        [STATISTIC_STALLS] = result->stalls,
        [STATISTIC_STALLED] = result->stalled_s,
        [STATISTIC_MEAN_SPEED] = result->mean_speed_m_s,
        [STATISTIC_FINAL_X] = result->final_x_m,
        [STATISTIC_FINAL_Y] = result->final_y_m,
        [STATISTIC_FINAL_HEADING] = result->final_heading_rad,
    };
    return values[statistic];
}

static double of_run(const struct report_data *data, enum experiment_statistic statistic)
{
    const struct report_input *in = data->input;
    const double values[STATISTICS] = {
        [STATISTIC_SIM_TIME] = in->sim_time_s,
        [STATISTIC_WALL_TIME] = in->wall_time_s,
        [STATISTIC_REAL_TIME_FACTOR] = in->wall_time_s > 0 ? in->sim_time_s / in->wall_time_s : 0,
        [STATISTIC_EXPLORED] = data->result->explored_fraction,
        [STATISTIC_SENT] = (double)in->mail.sent,
        [STATISTIC_DELIVERED] = (double)in->mail.delivered,
        [STATISTIC_WAITING] = (double)in->mail.waiting,
        [STATISTIC_EXPIRED] = (double)in->mail.expired,
        [STATISTIC_REFUSED] = (double)in->mail.refused,
        [STATISTIC_LOST] = (double)in->mail.lost,
        [STATISTIC_DUPLICATED] = (double)in->mail.duplicated,
    };
    bool of_mail = statistic >= STATISTIC_SENT && statistic <= STATISTIC_DUPLICATED;
    return of_mail && in->mail_unknown ? (double)NAN : values[statistic];
}

double report_statistic(const struct report_data *data, enum experiment_statistic statistic,
                        int robot)
{
    double sum = 0;
    if (statistic >= STATISTIC_SIM_TIME) {
        return of_run(data, statistic);
    }
    const char *name = robot >= 0 ? data->input->experiment->robots[robot].name : NULL;
    for (size_t i = 0; name && i < data->input->agents_count; i++) {
        if (strcmp(data->input->agents[i].name, name) == 0) {
            return of_agent(&data->input->agents[i], statistic);
        }
    }
    for (size_t i = 0; i < data->input->robots_count; i++) {
        if (name && strcmp(data->input->robots[i].name, name) == 0) {
            return of_robot(data, statistic, i);
        }
        sum += of_robot(data, statistic, i);
    }
    bool all = robot < 0 && data->input->robots_count > 0;
    return all ? sum / (double)data->input->robots_count : (double)NAN;
}
