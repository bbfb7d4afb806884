/* SPDX-License-Identifier: Apache-2.0 */
/* report.html: one page without scripts or links to elsewhere. */
#include "report/report_data.h"

#include <inttypes.h>
#include <math.h>
#include <string.h>
#include <unistd.h>

static const char *verdict(const struct report_data *data)
{
    return data->input->experiment->expect_count == 0        ? "nothing was expected of it"
           : data->result->all_met && data->input->broke_off ? "everything as expected so far"
           : data->result->all_met                           ? "everything as expected"
                                                             : "not everything as expected";
}

static const char *verdict_class(const struct report_data *data)
{
    return data->input->experiment->expect_count == 0 ? "soft"
           : data->result->all_met                    ? "met"
                                                      : "failed";
}

static void html_head(FILE *file, const struct report_data *data)
{
    const struct report_input *input = data->input;
    char title[192];
    snprintf(title, sizeof title, "%s, seed %" PRIu64, input->experiment->name, input->seed);
    page_open(file, title, input->experiment->name);
    fprintf(file, "<p class=\"soft\">seed %" PRIu64 ", %.1f s of simulated time, ", input->seed,
            input->sim_time_s);
    if (input->broke_off) {
        fputs("<span class=\"failed\">where it broke off</span>, ", file);
    }
    fprintf(file, "%zu robot%s: <span class=\"%s\">%s</span></p>\n", input->robots_count,
            input->robots_count == 1 ? "" : "s", verdict_class(data), verdict(data));
}

static void html_expectations(FILE *file, const struct report_data *data)
{
    unsigned count = data->input->experiment->expect_count;
    if (count == 0) {
        return;
    }
    fputs("<h2>Expectations</h2>\n<table class=\"text\">\n<tr><th>expected</th><th>measured</th>"
          "<th>met</th></tr>\n",
          file);
    for (unsigned i = 0; i < count; i++) {
        const struct report_result *result = data->result;
        const char *verdict = !result->judged[i] ? "<td class=\"soft\">not judged"
                              : result->met[i]   ? "<td class=\"met\">\xe2\x9c\x93 met"
                                                 : "<td class=\"failed\">\xe2\x9c\x97 failed";
        fputs("<tr><td>", file);
        svg_escape(file, result->texts[i]);
        fputs("</td><td>", file);
        svg_escape(file, result->measured[i]);
        fprintf(file, "</td>%s</td></tr>\n", verdict);
    }
    fputs("</table>\n", file);
}

static void html_robots(FILE *file, const struct report_data *data)
{
    fputs("<h2>Robots</h2>\n<div class=\"wide\"><table "
          "class=\"many\">\n<tr><th>robot</th><th>distance</th>"
          "<th>mean speed</th><th>stalls</th><th>stalled</th><th>longest stall</th>"
          "<th>mail sent</th><th>received</th><th>rule firings</th><th>stands at</th>"
          "<th>heading</th></tr>\n",
          file);
    for (size_t i = 0; i < data->input->robots_count; i++) {
        const struct report_robot *robot = &data->input->robots[i];
        const struct report_robot_result *result = &data->result->robots[i];
        fprintf(file, "<tr><td><span class=\"swatch\" style=\"--light:%s;--dark:%s\"></span>",
                data->colors[i].light, data->colors[i].dark);
        svg_escape(file, robot->name);
        fprintf(file, "</td><td>%.2f m</td><td>%.3f m/s</td><td>%" PRIu32 "</td><td>%.1f s</td>",
                result->distance_m, result->mean_speed_m_s, result->stalls, result->stalled_s);
        fprintf(file, "<td>%.1f s</td><td>%" PRIu64 "</td><td>%" PRIu64 "</td><td>%" PRIu64 "</td>",
                result->longest_stall_s, robot->mail_sent, robot->mail_received,
                robot->rule_firings);
        fprintf(file, "<td>%.2f, %.2f m</td><td>%.0f\xc2\xb0</td></tr>\n", result->final_x_m,
                result->final_y_m, result->final_heading_rad * 180 / M_PI);
    }
    fputs("</table></div>\n", file);
}

static void html_agents(FILE *file, const struct report_input *input)
{
    if (input->agents_count == 0) {
        return;
    }
    fputs("<h2>Agents without a body</h2>\n<div class=\"wide\"><table "
          "class=\"many\">\n<tr><th>agent</th><th>mail sent</th><th>received</th>"
          "<th>rule firings</th></tr>\n",
          file);
    for (size_t i = 0; i < input->agents_count; i++) {
        const struct report_robot *agent = &input->agents[i];
        fputs("<tr><td>", file);
        svg_escape(file, agent->name);
        fprintf(file, "</td><td>%" PRIu64 "</td><td>%" PRIu64 "</td><td>%" PRIu64 "</td></tr>\n",
                agent->mail_sent, agent->mail_received, agent->rule_firings);
    }
    fputs("</table></div>\n", file);
}

static void html_fact(FILE *file, const char *what, const char *value)
{
    fprintf(file, "<dt>%s</dt><dd>", what);
    svg_escape(file, value);
    fputs("</dd>\n", file);
}

static void html_facts(FILE *file, const struct report_data *data)
{
    const struct report_input *input = data->input;
    const struct report_mail *mail = &input->mail;
    char text[256];
    fputs("<h2>The run</h2>\n<dl>\n", file);
    html_fact(file, "hash", input->hash);
    snprintf(text, sizeof text, "%" PRIu64, input->seed);
    html_fact(file, "seed", text);
    snprintf(text, sizeof text, "%.3f s simulated in %.3f s: %.1f times real time",
             input->sim_time_s, input->wall_time_s,
             input->wall_time_s > 0 ? input->sim_time_s / input->wall_time_s : 0);
    html_fact(file, "time", text);
    snprintf(text, sizeof text, "%.1f %% of the floor", data->result->explored_fraction * 100);
    html_fact(file, "explored", text);
    snprintf(text, sizeof text, "%s, %.3f m for each second that it was not stalled, by run.csv",
             data->result->most_efficient ? data->result->most_efficient : "",
             data->result->efficiency_m_s);
    html_fact(file, "most efficient",
              data->result->most_efficient ? text : "no robot moved for half of the time");
    snprintf(text, sizeof text,
             "%" PRIu64 " sent, %" PRIu64 " delivered, %" PRIu64 " waiting, %" PRIu64
             " expired, %" PRIu64 " refused, %" PRIu64 " lost, %" PRIu64 " duplicated",
             mail->sent, mail->delivered, mail->waiting, mail->expired, mail->refused, mail->lost,
             mail->duplicated);
    html_fact(file, "mail",
              input->mail_unknown ? "not known: the brokers' counters are lost" : text);
    if (data->events->left_out > 0) {
        snprintf(text, sizeof text, "%zu; %zu that came later are not judged", data->events->count,
                 data->events->left_out);
        html_fact(file, "events", text);
    }
    html_fact(file, "world", input->world->file);
    html_fact(file, "experiment", input->experiment->file ? input->experiment->file : "");
    html_fact(file, "made with", input->versions ? input->versions : "");
    html_fact(file, "arithmetic", input->arithmetic ? input->arithmetic : "");
    fputs("</dl>\n<h2>Run it again</h2>\n<pre>", file);
    svg_escape(file, input->command);
    fprintf(file, "</pre>\n<p class=\"soft\">%s</p>\n",
            strcmp(input->hash, "none") != 0
                ? "The same seed gives the same hash, on every processor."
                : "This run has no hash: it ran free, or did not come to its end.");
}

static void html_files(FILE *file, const char *folder)
{
    static const char *const names[] = {"summary.json", "run.csv",     "events.csv",
                                        "tracks.svg",   "bearing.svg", "run.mcap"};
    fputs("<h2>Files</h2>\n<p>", file);
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
        char path[REPORT_PATH_MAX];
        int len = snprintf(path, sizeof path, "%s/%s", folder, names[i]);
        if (len > 0 && (size_t)len < sizeof path && access(path, F_OK) == 0) {
            fprintf(file, "<a href=\"%s\">%s</a> ", names[i], names[i]);
        }
    }
    fputs("</p>\n", file);
}

/* Commands, chaos and expectations beside each other; without any there is nothing to see. */
static void html_timeline(FILE *file, const struct report_data *data)
{
    const struct experiment *e = data->input->experiment;
    if (e->observer_count + e->chaos_count + e->expect_count > 0) {
        fputs("<h2>What happened when</h2>\n<figure>\n", file);
        report_write_timeline(file, data);
        fputs("</figure>\n", file);
    }
}

/* What was to go wrong, and what became of it. */
static void html_chaos(FILE *file, const struct report_data *data)
{
    const struct experiment *e = data->input->experiment;
    if (e->chaos_count == 0) {
        return;
    }
    fputs("<h2>Chaos</h2>\n<table class=\"text\">\n<tr><th>what</th><th>at</th>"
          "<th>done</th></tr>\n",
          file);
    for (unsigned i = 0; i < e->chaos_count; i++) {
        const struct report_chaos *fate = &data->input->chaos[i];
        fputs("<tr><td>", file);
        svg_escape(file, e->chaos[i].text);
        if (fate->done) {
            fprintf(file, "</td><td>%.1f s</td><td class=\"met\">done</td></tr>\n", fate->at_s);
        } else {
            fputs("</td><td></td><td class=\"soft\">", file);
            svg_escape(file, fate->reason[0] ? fate->reason : "its time has not come");
            fputs("</td></tr>\n", file);
        }
    }
    fputs("</table>\n", file);
}

/* The monitors, their logs, and whether each lived to the end. */
static void html_monitors(FILE *file, const struct report_input *input)
{
    if (input->monitors_count == 0) {
        return;
    }
    fputs("<h2>Monitors</h2>\n<table class=\"text\">\n<tr><th>name</th><th>rules or program</th>"
          "<th>what it said</th><th>ended</th></tr>\n",
          file);
    for (size_t i = 0; i < input->monitors_count; i++) {
        const struct report_monitor *m = &input->monitors[i];
        fprintf(file, "<tr><td>%s</td><td>", m->name);
        svg_escape(file, m->rules ? m->rules : m->program);
        fprintf(file, "</td><td><a href=\"%s.log\">%s.log</a></td><td class=\"%s\">", m->name,
                m->name, m->fate ? "failed" : "met");
        svg_escape(file, m->fate ? m->fate : "with the run");
        fputs("</td></tr>\n", file);
    }
    fputs("</table>\n", file);
}

static void html_undone(FILE *file, const struct report_input *input)
{
    if (input->undone_count == 0) {
        return;
    }
    fputs("<h2>What did not happen</h2>\n<ul>\n", file);
    for (size_t i = 0; i < input->undone_count; i++) {
        fputs("<li class=\"failed\">", file);
        svg_escape(file, input->undone[i]);
        fputs("</li>\n", file);
    }
    fputs("</ul>\n", file);
}

void report_write_html(FILE *file, const struct report_data *data, const char *folder)
{
    html_head(file, data);
    html_expectations(file, data);
    html_undone(file, data->input);
    html_chaos(file, data);
    html_timeline(file, data);
    fputs("<h2>Tracks</h2>\n<figure>\n", file);
    report_write_tracks(file, data);
    fputs("</figure>\n<h2>Bearing</h2>\n<figure>\n", file);
    report_write_bearing(file, data);
    fputs("</figure>\n", file);
    html_robots(file, data);
    html_agents(file, data->input);
    html_monitors(file, data->input);
    html_facts(file, data);
    html_files(file, folder);
    page_close(file);
}
