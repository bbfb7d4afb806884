/* SPDX-License-Identifier: Apache-2.0 */
#include "core/text.h"
#include "muster/memory.h"
#include "report/report_data.h"

#include <math.h>
#include <string.h>

/* How far a near-expectation is counted. */
struct expect_near {
    size_t robot, mate; /* in report_input; robots_count: not there */
    size_t steps, near_steps;
};

struct report_expect {
    const struct report_input *input;
    struct expect_near near[EXPERIMENT_EXPECTATIONS_MAX];
    struct report_row *rows; /* the last of each robot */
    bool *seen;
    bool any;
    double time_s;
    size_t outside_rows;
    size_t outside_robot; /* the first that was */
    double outside_s;
};

static size_t expect_find(const struct report_input *input, const char *name)
{
    size_t i = 0;
    while (i < input->robots_count && strcmp(input->robots[i].name, name) != 0) {
        i++;
    }
    return i;
}

struct report_expect *report_expect_open(const struct report_input *input)
{
    const struct experiment *e = input->experiment;
    struct report_expect *x = mu_startup_alloc(sizeof *x);
    MU_ASSERT(e->expect_count <= EXPERIMENT_EXPECTATIONS_MAX);
    x->input = input;
    x->rows = mu_startup_array(input->robots_count, sizeof *x->rows);
    x->seen = mu_startup_array(input->robots_count, sizeof *x->seen);
    for (unsigned i = 0; i < e->expect_count; i++) {
        if (e->expect[i].near_robot) {
            x->near[i].robot = expect_find(input, e->expect[i].near_robot);
            x->near[i].mate = expect_find(input, e->expect[i].near_mate);
        }
    }
    return x;
}

/* Looks at all robots, now that each has its row of this time. */
static void expect_end_step(struct report_expect *x)
{
    const struct experiment *e = x->input->experiment;
    /* Times are sums of steps, so they miss a whole number by a little. */
    double tolerance_s = e->step_ms / 1e3 / 1000;
    for (unsigned i = 0; i < e->expect_count; i++) {
        const struct experiment_expectation *expect = &e->expect[i];
        struct expect_near *near = &x->near[i];
        bool in_time =
            x->time_s >= expect->from_s - tolerance_s && x->time_s <= expect->to_s + tolerance_s;
        if (!expect->near_robot || !in_time) {
            continue;
        }
        near->steps++;
        size_t count = x->input->robots_count;
        if (near->robot < count && near->mate < count && x->seen[near->robot] &&
            x->seen[near->mate]) {
            const struct report_row *a = &x->rows[near->robot], *b = &x->rows[near->mate];
            near->near_steps += hypot(a->x_m - b->x_m, a->y_m - b->y_m) <= expect->within_m;
        }
    }
}

void report_expect_row(struct report_expect *x, const struct report_row *row)
{
    if (x->any && row->time_s > x->time_s) {
        expect_end_step(x);
    }
    x->any = true;
    x->time_s = row->time_s;
    x->rows[row->robot] = *row;
    x->seen[row->robot] = true;
    const struct world *w = x->input->world;
    if (row->x_m < w->min_x_m || row->x_m > w->max_x_m || row->y_m < w->min_y_m ||
        row->y_m > w->max_y_m) {
        if (x->outside_rows == 0) {
            x->outside_robot = row->robot;
            x->outside_s = row->time_s;
        }
        x->outside_rows++;
    }
}

static void expect_judge_near(const struct report_expect *x, unsigned i,
                              struct report_result *result)
{
    const struct experiment_expectation *expect = &x->input->experiment->expect[i];
    const struct expect_near *near = &x->near[i];
    double share = near->steps ? (double)near->near_steps / (double)near->steps : 0;
    struct mu_text text = mu_text_in(result->texts[i], sizeof result->texts[i]);
    struct mu_text measured = mu_text_in(result->measured[i], sizeof result->measured[i]);
    double end_s = fmin(expect->to_s, x->input->experiment->duration);
    mu_text_format(&text, "%s within %g m of %s for at least %g %% of %g to %g s",
                   expect->near_robot, expect->within_m, expect->near_mate, expect->share * 100,
                   expect->from_s, end_s);
    result->judged[i] = expect->from_s < x->input->experiment->duration;
    result->met[i] = !result->judged[i] || (near->steps > 0 && share >= expect->share - 1e-12);
    if (!result->judged[i]) {
        mu_text_clear(&text);
        mu_text_format(&text, "%s within %g m of %s from %g s on", expect->near_robot,
                       expect->within_m, expect->near_mate, expect->from_s);
        mu_text_add(&measured, "not reached: the run was cut short");
    } else if (near->steps == 0) {
        mu_text_add(&measured, "the run ended before");
    } else {
        mu_text_format(&measured, "%.1f %%", share * 100);
    }
}

static void expect_judge_inside(const struct report_expect *x, unsigned i,
                                struct report_result *result)
{
    mu_text_copy(result->texts[i], sizeof result->texts[i], "no robot outside the arena");
    struct mu_text measured = mu_text_in(result->measured[i], sizeof result->measured[i]);
    result->judged[i] = true;
    result->met[i] = x->any && x->outside_rows == 0;
    if (x->outside_rows > 0) {
        mu_text_format(&measured, "%s was outside at %g s", x->input->robots[x->outside_robot].name,
                       x->outside_s);
    } else {
        mu_text_add(&measured, x->any ? "none was" : "the run has no rows");
    }
}

static void expect_judge_stall(const struct report_expect *x, unsigned i,
                               struct report_result *result)
{
    double limit_s = x->input->experiment->expect[i].stall_max_s;
    double longest_s = 0;
    const char *who = "none";
    for (size_t r = 0; r < x->input->robots_count; r++) {
        if (result->robots[r].longest_stall_s > longest_s) {
            longest_s = result->robots[r].longest_stall_s;
            who = x->input->robots[r].name;
        }
    }
    struct mu_text text = mu_text_in(result->texts[i], sizeof result->texts[i]);
    struct mu_text measured = mu_text_in(result->measured[i], sizeof result->measured[i]);
    mu_text_format(&text, "no robot stalled for more than %g s in a row", limit_s);
    mu_text_format(&measured, "%s, %.1f s", who, longest_s);
    result->judged[i] = true;
    result->met[i] = x->any && longest_s <= limit_s + 1e-9;
}

/* A name, or the beginning of some with * behind it. */
static bool expect_is_meant(const char *pattern, const char *name)
{
    size_t len = strlen(pattern);
    bool begins = len > 0 && pattern[len - 1] == '*';
    return begins ? strncmp(pattern, name, len - 1) == 0 : strcmp(pattern, name) == 0;
}

static void expect_judge_objects(const struct report_expect *x, unsigned i,
                                 struct report_result *result)
{
    const struct experiment_expectation *expect = &x->input->experiment->expect[i];
    unsigned there = 0, meant = 0;
    for (size_t k = 0; k < x->input->objects_count; k++) {
        const struct report_object *o = &x->input->objects[k];
        bool is_meant = expect_is_meant(expect->objects, o->name);
        double far_m = hypot(o->pose.x_m - expect->at->x_m, o->pose.y_m - expect->at->y_m);
        meant += is_meant;
        there += is_meant && far_m <= expect->within_m;
    }
    unsigned wanted = expect->count > 0 ? expect->count : meant;
    struct mu_text text = mu_text_in(result->texts[i], sizeof result->texts[i]);
    struct mu_text measured = mu_text_in(result->measured[i], sizeof result->measured[i]);
    bool all = strcmp(expect->objects, "*") == 0;
    mu_text_format(&text, "%u of %s within %g m of %g, %g at the end", wanted,
                   all ? "all things" : expect->objects, expect->within_m, expect->at->x_m,
                   expect->at->y_m);
    /* As with near: what is expected from a time on says nothing of a run that was cut short. */
    result->judged[i] = expect->from_s < x->input->experiment->duration;
    result->met[i] = !result->judged[i] || (meant > 0 && there >= wanted);
    if (result->judged[i]) {
        mu_text_format(&measured, "%u of %u", there, meant);
    } else {
        mu_text_add(&measured, "not reached: the run was cut short");
    }
}

/* What is expected from a time on says nothing of a run that was cut short before. */
static void expect_judge_cut(const struct report_data *data, unsigned i)
{
    const struct experiment *e = data->input->experiment;
    struct report_result *result = data->result;
    result->judged[i] = e->expect[i].from_s < e->duration;
    if (!result->judged[i]) {
        result->met[i] = true;
        mu_text_copy(result->measured[i], sizeof result->measured[i],
                     "not reached: the run was cut short");
    }
}

static void expect_judge_statistic(const struct report_data *data, unsigned i)
{
    const struct experiment *e = data->input->experiment;
    const struct experiment_expectation *expect = &e->expect[i];
    struct report_result *result = data->result;
    int robot;
    enum experiment_statistic statistic = experiment_statistic_find(e, expect->statistic, &robot);
    double value = report_statistic(data, statistic, robot);
    struct mu_text text = mu_text_in(result->texts[i], sizeof result->texts[i]);
    mu_text_format(&text, "%s", expect->statistic);
    if (isfinite(expect->at_least)) {
        mu_text_format(&text, " at least %g", expect->at_least);
    }
    if (isfinite(expect->at_most)) {
        mu_text_format(&text, "%s at most %g", isfinite(expect->at_least) ? " and" : "",
                       expect->at_most);
    }
    result->met[i] = value >= expect->at_least && value <= expect->at_most;
    snprintf(result->measured[i], sizeof result->measured[i], "%.6g", value);
    expect_judge_cut(data, i);
    if (isnan(value)) {
        result->judged[i] = false;
        result->met[i] = true;
        mu_text_copy(result->measured[i], sizeof result->measured[i],
                     "not known: the brokers' counters are lost");
    }
}

/* Follows a sequence from one occurrence of its first event on, always to the next that fits.
 * Before, places holds where its events came behind an earlier first one: no later first one's
 * events come before them, so that all searches together read the list once.
 * @return how many events of it came */
static unsigned expect_follow(const struct report_data *data, unsigned i, size_t *places)
{
    const struct experiment *e = data->input->experiment;
    for (unsigned k = 1; k < e->expect[i].sequence_count; k++) {
        unsigned event = experiment_event_find(e, e->expect[i].sequence[k]);
        size_t from = places[k] > places[k - 1] ? places[k] : places[k - 1] + 1;
        places[k] = report_events_next(data->events, event, from);
        if (places[k] == data->events->count) {
            return k;
        }
    }
    return e->expect[i].sequence_count;
}

static void expect_sequence_text(const struct experiment_expectation *expect, struct mu_text *text)
{
    for (unsigned k = 0; k < expect->sequence_count; k++) {
        mu_text_format(text, "%s%s", k ? ", then " : "", expect->sequence[k]);
    }
    if (expect->within_s > 0) {
        mu_text_format(text, ", within %g s", expect->within_s);
    }
}

static void expect_judge_sequence(const struct report_data *data, unsigned i)
{
    const struct experiment *e = data->input->experiment;
    const struct experiment_expectation *expect = &e->expect[i];
    const struct report_events *events = data->events;
    struct report_result *result = data->result;
    unsigned first_event = experiment_event_find(e, expect->sequence[0]);
    unsigned all = expect->sequence_count, came = all, best = 0;
    size_t places[EXPERIMENT_SEQUENCE_MAX] = {0};
    bool met = false;
    struct mu_text text, when;
    mu_text_init(&text, result->texts[i], sizeof result->texts[i]);
    expect_sequence_text(expect, &text);
    /* What does not come behind one first event comes behind no later one. */
    while (!met && came == all &&
           (places[0] = report_events_next(events, first_event, places[0])) < events->count) {
        double first_s = (double)events->at[places[0]].time_s;
        if (first_s >= expect->from_s - 1e-6) {
            came = expect_follow(data, i, places);
            best = came > best ? came : best;
            met = came == all &&
                  (expect->within_s <= 0 ||
                   (double)events->at[places[all - 1]].time_s - first_s <= expect->within_s + 1e-6);
        }
        places[0] += !met;
    }
    result->met[i] = met;
    mu_text_init(&when, result->measured[i], sizeof result->measured[i]);
    if (best < all) {
        mu_text_format(&when, "no: %.100s", expect->sequence[best]);
    } else if (!met) {
        mu_text_format(&when, "never so soon");
    }
    for (unsigned k = 0; met && k < all; k++) {
        mu_text_format(&when, "%s%.1f%s", k ? ", " : "at ", (double)events->at[places[k]].time_s,
                       k + 1 == all ? " s" : "");
    }
}

static void expect_judge_never(const struct report_data *data, unsigned i)
{
    const struct experiment *e = data->input->experiment;
    struct report_result *result = data->result;
    unsigned event = experiment_event_find(e, e->expect[i].never), times = 0;
    double first_s = 0;
    size_t at = 0;
    while ((at = report_events_next(data->events, event, at)) < data->events->count) {
        double time_s = (double)data->events->at[at++].time_s;
        if (time_s >= e->expect[i].from_s - 1e-6) {
            first_s = times ? first_s : time_s;
            times++;
        }
    }
    snprintf(result->texts[i], sizeof result->texts[i], "never: %.200s", e->expect[i].never);
    result->met[i] = times == 0;
    if (times > 0) {
        snprintf(result->measured[i], sizeof result->measured[i], "%u times, first at %.1f s",
                 times, first_s);
    } else {
        mu_text_copy(result->measured[i], sizeof result->measured[i], "it never was");
    }
}

static void expect_judge(struct report_expect *x, const struct report_data *data, unsigned i)
{
    const struct experiment_expectation *expect = &data->input->experiment->expect[i];
    struct report_result *result = data->result;
    if (expect->near_robot) {
        expect_judge_near(x, i, result);
    } else if (expect->objects) {
        expect_judge_objects(x, i, result);
    } else if (expect->inside) {
        expect_judge_inside(x, i, result);
    } else if (expect->statistic) {
        expect_judge_statistic(data, i);
    } else if (expect->never) {
        expect_judge_never(data, i);
        expect_judge_cut(data, i);
    } else if (expect->sequence_count > 0) {
        expect_judge_sequence(data, i);
        expect_judge_cut(data, i);
    } else {
        expect_judge_stall(x, i, result);
    }
}

void report_expect_close(struct report_expect *x, struct report_data *data)
{
    struct report_result *result = data->result;
    if (x->any) {
        expect_end_step(x);
    }
    result->all_met = true;
    for (unsigned i = 0; i < data->input->experiment->expect_count; i++) {
        expect_judge(x, data, i);
        result->all_met = result->all_met && result->met[i];
    }
}
