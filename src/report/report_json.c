/* SPDX-License-Identifier: Apache-2.0 */
/* summary.json */
#include "core/json.h"
#include "report/report_data.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>

/* What a mind does, with a body or without. */
static void json_add_agent(struct mu_json *j, const struct report_robot *agent)
{
    mu_json_uint(j, "mail_sent", agent->mail_sent);
    mu_json_uint(j, "mail_received", agent->mail_received);
    mu_json_uint(j, "rule_firings", agent->rule_firings);
}

static void json_write_robots(struct mu_json *j, const struct report_data *data)
{
    mu_json_list(j, "robots");
    for (size_t i = 0; i < data->input->robots_count; i++) {
        const struct report_robot *robot = &data->input->robots[i];
        const struct report_robot_result *result = &data->result->robots[i];
        mu_json_object(j, NULL);
        mu_json_string(j, "name", robot->name);
        mu_json_real(j, "distance_m", result->distance_m);
        mu_json_uint(j, "stalls", result->stalls);
        mu_json_real(j, "stalled_s", result->stalled_s);
        mu_json_real(j, "mean_speed_m_s", result->mean_speed_m_s);
        json_add_agent(j, robot);
        mu_json_object(j, "final");
        mu_json_real(j, "x_m", result->final_x_m);
        mu_json_real(j, "y_m", result->final_y_m);
        mu_json_real(j, "heading_rad", result->final_heading_rad);
        mu_json_end(j);
        mu_json_end(j);
    }
    mu_json_end(j);
}

static void json_write_agents(struct mu_json *j, const struct report_input *input)
{
    if (input->agents_count == 0) {
        return;
    }
    mu_json_list(j, "agents");
    for (size_t i = 0; i < input->agents_count; i++) {
        mu_json_object(j, NULL);
        mu_json_string(j, "name", input->agents[i].name);
        json_add_agent(j, &input->agents[i]);
        mu_json_end(j);
    }
    mu_json_end(j);
}

static void json_write_files(struct mu_json *j, const struct report_input *input)
{
    mu_json_list(j, "made_of");
    for (size_t i = 0; i < input->files_count; i++) {
        char hash[32];
        snprintf(hash, sizeof hash, "%016" PRIx64, input->files[i].hash);
        mu_json_object(j, NULL);
        mu_json_string(j, "file", input->files[i].name);
        mu_json_string(j, "hash", hash);
        mu_json_end(j);
    }
    mu_json_end(j);
}

static void json_write_objects(struct mu_json *j, const struct report_input *input)
{
    if (input->objects_count == 0) {
        return;
    }
    mu_json_list(j, "objects");
    for (size_t i = 0; i < input->objects_count; i++) {
        mu_json_object(j, NULL);
        mu_json_string(j, "name", input->objects[i].name);
        mu_json_real(j, "x_m", input->objects[i].pose.x_m);
        mu_json_real(j, "y_m", input->objects[i].pose.y_m);
        mu_json_real(j, "heading_rad", input->objects[i].pose.heading_rad);
        mu_json_end(j);
    }
    mu_json_end(j);
}

static void json_write_mail(struct mu_json *j, const struct report_input *input)
{
    const struct report_mail *mail = &input->mail;
    const struct {
        const char *key;
        uint64_t count;
    } counters[] = {{"sent", mail->sent},
                    {"delivered", mail->delivered},
                    {"waiting", mail->waiting},
                    {"expired", mail->expired},
                    {"refused", mail->refused},
                    {"lost", mail->lost},
                    {"duplicated", mail->duplicated}};
    mu_json_object(j, "mail");
    for (size_t i = 0; i < sizeof counters / sizeof counters[0]; i++) {
        if (input->mail_unknown) {
            mu_json_real(j, counters[i].key, (double)NAN);
        } else {
            mu_json_uint(j, counters[i].key, counters[i].count);
        }
    }
    mu_json_end(j);
}

static void json_write_restarts(struct mu_json *j, const struct report_input *input)
{
    if (input->restarts_count == 0) {
        return;
    }
    mu_json_list(j, "restarts");
    for (size_t i = 0; i < input->restarts_count; i++) {
        mu_json_object(j, NULL);
        mu_json_string(j, "process", input->restarts[i].name);
        mu_json_uint(j, "count", input->restarts[i].count);
        mu_json_end(j);
    }
    mu_json_end(j);
}

static void json_write_monitors(struct mu_json *j, const struct report_input *input)
{
    if (input->monitors_count == 0) {
        return;
    }
    mu_json_list(j, "monitors");
    for (size_t i = 0; i < input->monitors_count; i++) {
        const struct report_monitor *m = &input->monitors[i];
        char log[MU_NAME_MAX + sizeof ".log"];
        snprintf(log, sizeof log, "%s.log", m->name);
        mu_json_object(j, NULL);
        mu_json_string(j, "name", m->name);
        mu_json_string(j, m->rules ? "rules" : "program", m->rules ? m->rules : m->program);
        mu_json_string(j, "log", log);
        mu_json_string(j, "ended", m->fate ? m->fate : "with the run");
        mu_json_end(j);
    }
    mu_json_end(j);
}

static void json_write_expectations(struct mu_json *j, const struct report_data *data)
{
    mu_json_list(j, "expectations");
    for (unsigned i = 0; i < data->input->experiment->expect_count; i++) {
        if (!data->result->judged[i]) {
            continue;
        }
        mu_json_object(j, NULL);
        mu_json_string(j, "text", data->result->texts[i]);
        mu_json_bool(j, "met", data->result->met[i]);
        mu_json_end(j);
    }
    mu_json_end(j);
}

static void json_write_chaos(struct mu_json *j, const struct report_input *input)
{
    if (input->experiment->chaos_count == 0) {
        return;
    }
    mu_json_list(j, "chaos");
    for (unsigned i = 0; i < input->experiment->chaos_count; i++) {
        const struct report_chaos *chaos = &input->chaos[i];
        mu_json_object(j, NULL);
        mu_json_real(j, "at_s", chaos->done ? chaos->at_s : (double)NAN);
        mu_json_string(j, "text", input->experiment->chaos[i].text);
        mu_json_bool(j, "done", chaos->done);
        if (!chaos->done && chaos->reason[0]) {
            mu_json_string(j, "reason", chaos->reason);
        }
        mu_json_end(j);
    }
    mu_json_end(j);
    mu_json_uint(j, "packets_struck", input->packets_struck);
}

void report_write_json(FILE *file, const struct report_data *data)
{
    const struct report_input *input = data->input;
    struct mu_json j;
    mu_json_to_file(&j, file, MU_JSON_INDENTED);
    mu_json_object(&j, NULL);
    mu_json_string(&j, "experiment", input->experiment->name);
    mu_json_uint(&j, "seed", input->seed);
    mu_json_string(&j, "hash", input->hash);
    mu_json_string(&j, "command", input->command);
    mu_json_string(&j, "file", input->file);
    mu_json_real(&j, "duration_s", input->experiment->duration);
    mu_json_bool(&j, "free", input->free);
    mu_json_string(&j, "made_with", input->versions);
    mu_json_string(&j, "arithmetic", input->arithmetic);
    mu_json_string(&j, "architecture", input->architecture);
    mu_json_string(&j, "processor", input->processor);
    mu_json_list(&j, "overrides");
    for (size_t i = 0; i < input->overrides_count; i++) {
        mu_json_string(&j, NULL, input->overrides[i]);
    }
    mu_json_end(&j);
    json_write_files(&j, input);
    if (input->broke_off) {
        mu_json_bool(&j, "broke_off", true);
    }
    mu_json_real(&j, "sim_time_s", input->sim_time_s);
    mu_json_real(&j, "wall_time_s", input->wall_time_s);
    mu_json_real(&j, "real_time_factor",
                 input->wall_time_s > 0 ? input->sim_time_s / input->wall_time_s : 0);
    json_write_robots(&j, data);
    json_write_agents(&j, input);
    json_write_objects(&j, input);
    mu_json_real(&j, "explored_fraction", data->result->explored_fraction);
    mu_json_string(&j, "most_efficient", data->result->most_efficient);
    mu_json_real(&j, "most_efficient_m_s", data->result->efficiency_m_s);
    json_write_mail(&j, input);
    json_write_restarts(&j, input);
    json_write_monitors(&j, input);
    json_write_chaos(&j, input);
    json_write_expectations(&j, data);
    if (input->undone_count > 0) {
        mu_json_list(&j, "undone");
        for (size_t i = 0; i < input->undone_count; i++) {
            mu_json_string(&j, NULL, input->undone[i]);
        }
        mu_json_end(&j);
    }
    mu_json_end(&j);
}
