/* SPDX-License-Identifier: Apache-2.0 */
/* muster top: what a run amounts to, while it goes on. */
#include "cli/terminal/terminal.h"
#include "cli/verbs.h"
#include "core/clock.h"
#include "core/exits.h"
#include "core/network.h"
#include "core/options.h"
#include "muster/memory.h"
#include "operator/operator.h"

#include <poll.h>
#include <signal.h>
#include <string.h>
#include <unistd.h>

/* A single question waits so long for an answer. */
static const uint64_t ONCE_PATIENCE_NS = 5000000000;
static const double GOAL_NEAR_M = 0.25;

enum { ROUND_MS = 50, HEAD_LINES = TOP_TEAM_LINES + 2 };

static struct {
    struct mu_network network;
    const char *sort;
    double every_s;
    bool json, once;
    struct mu_option_list goals;
} set;

static struct top {
    mu_watch *watch;
    mu_stats *stats;
    bool screen, news; /* news: something has not been shown yet */
    int column;
    size_t order[MU_ROBOTS_MAX + MU_AGENTS_MAX];
    struct palette_color colors[MU_ROBOTS_MAX]; /* in the scene's order */
    size_t first;                               /* row that is shown at the top */
    uint64_t shown_ns;
    bool ended;
    enum mu_run_end end;
    struct top_line end_line, line;
    int domain;
} top;

static volatile sig_atomic_t signal_came;

static void signal_note(int number)
{
    signal_came = number;
}

/* --- what is seen ----------------------------------------------------------------------------- */

/* @return whether a text is NAME=X,Y or NAME=X,Y,NEAR */
static bool goal_read(const char *text, char name[MU_NAME_MAX + 1], double at[3])
{
    int end = -1;
    at[2] = GOAL_NEAR_M;
    _Static_assert(MU_NAME_MAX == 31, "the width below");
    if (sscanf(text, "%31[^=]=%lf,%lf%n", name, &at[0], &at[1], &end) < 3 || end < 0) {
        return false;
    }
    const char *rest = text + end;
    int more = -1;
    return *rest == '\0' || (sscanf(rest, ",%lf%n", &at[2], &more) == 1 && more >= 0 &&
                             rest[more] == '\0' && at[2] > 0);
}

static void goals_set(void)
{
    char name[MU_NAME_MAX + 1];
    double at[3];
    for (size_t i = 0; i < set.goals.count; i++) {
        if (goal_read(set.goals.items[i], name, at) &&
            mu_stats_goal(top.stats, name, at[0], at[1], at[2]) != MU_OK) {
            fprintf(stderr, "muster top: --goal %s: there is no such robot\n", name);
        }
    }
}

static void on_scene(void *self, const struct mu_scene *scene)
{
    static struct palette_robot wishes[MU_ROBOTS_MAX];
    (void)self;
    mu_stats_begin(top.stats, scene);
    size_t count = scene->robot_count < MU_ROBOTS_MAX ? scene->robot_count : MU_ROBOTS_MAX;
    for (size_t i = 0; i < count; i++) {
        const struct mu_figure *f = &scene->robots[i];
        wishes[i] = (struct palette_robot){f->name, f->shape.rgb, !f->controlled};
    }
    palette_choose(top.colors, wishes, count);
    top.ended = false;
    goals_set();
}

static void on_step(void *self, const struct mu_frame *frame)
{
    (void)self;
    mu_stats_take(top.stats, frame);
    top.news = true;
}

static void table_print(void);

static void on_end(void *self, const struct mu_run_result *result)
{
    (void)self;
    top.ended = true;
    top.end = result->end;
    top.news = true;
    top_table_end(&top.end_line, result);
    if (top.screen) {
        return;
    }
    table_print();
    if (set.json) {
        top_table_json_end(stdout, top.stats, result);
    } else {
        puts(top.end_line.bytes);
    }
}

/* --- as lines --------------------------------------------------------------------------------- */

static void table_print(void)
{
    size_t count = top_table_rows(top.stats);
    top_table_sort(top.stats, top.column, top.order);
    for (size_t i = 0; set.json && i < count; i++) {
        top_table_json(stdout, top.stats, top.order[i]);
    }
    for (size_t i = 0; !set.json && i < TOP_TEAM_LINES; i++) {
        top_table_team(&top.line, top.stats, i);
        puts(top.line.bytes);
    }
    size_t columns = top_table_columns(0);
    if (!set.json) {
        top_table_head(&top.line, columns, top.column);
        puts(top.line.bytes);
    }
    for (size_t i = 0; !set.json && i < count; i++) {
        top_table_row(&top.line, top.stats, top.order[i], columns);
        puts(top.line.bytes);
    }
    fflush(stdout);
    top.news = false;
}

/* --- on a terminal ---------------------------------------------------------------------------- */

static void status_draw(void)
{
    char line[TOP_LINE_MAX];
    if (top.ended) {
        top_screen_line(top.end_line.bytes, true);
        return;
    }
    bool there = mu_stats_team(top.stats).step >= 0;
    snprintf(line, sizeof line, "%s  sorted by %s; s sorts by the next, arrows move, q ends",
             there ? "running" : "no run yet", top_table_key_of(top.column));
    top_screen_line(line, false);
}

/* Agents without a body have no colour. */
static void row_draw(size_t row)
{
    if (row < mu_stats_count(top.stats)) {
        top_screen_robot(top.line.bytes, &top.colors[row]);
    } else {
        top_screen_line(top.line.bytes, false);
    }
}

static void screen_draw(void)
{
    size_t wide, high, count = top_table_rows(top.stats);
    top_screen_size(&wide, &high);
    size_t rows = high > HEAD_LINES ? high - HEAD_LINES : 0;
    size_t last = count > rows ? count - rows : 0;
    top.first = top.first < last ? top.first : last;
    top_table_sort(top.stats, top.column, top.order);
    top_screen_begin();
    for (size_t i = 0; i < TOP_TEAM_LINES; i++) {
        top_table_team(&top.line, top.stats, i);
        top_screen_line(top.line.bytes, false);
    }
    status_draw();
    size_t columns = top_table_columns(wide);
    top_table_head(&top.line, columns, top.column);
    top_screen_line(top.line.bytes, true);
    for (size_t i = top.first; i < count && i - top.first < rows; i++) {
        top_table_row(&top.line, top.stats, top.order[i], columns);
        row_draw(top.order[i]);
    }
    top_screen_show();
    top.news = false;
}

/* @return false: it is to end */
static bool key_take(enum top_key key)
{
    size_t wide, high;
    top_screen_size(&wide, &high);
    size_t page = high > HEAD_LINES + 1 ? high - HEAD_LINES - 1 : 1;
    size_t up = key == TOP_KEY_UP ? 1 : key == TOP_KEY_PAGE_UP ? page : 0;
    size_t down = key == TOP_KEY_DOWN ? 1 : key == TOP_KEY_PAGE_DOWN ? page : 0;
    top.first = top.first > up ? top.first - up : 0;
    top.first += down; /* drawing finds the last */
    int turn = (key == TOP_KEY_SORT) - (key == TOP_KEY_SORT_BACK);
    top.column = top_table_key(top_table_key_of(top.column + turn));
    return key != TOP_KEY_QUIT;
}

/* @return false: it is to end */
static bool screen_round(void)
{
    static size_t wide_before, high_before;
    size_t wide, high;
    bool changed = false;
    enum top_key key;
    while ((key = top_screen_key()) != TOP_KEY_NONE) {
        changed = true;
        if (!key_take(key)) {
            return false;
        }
    }
    top_screen_size(&wide, &high);
    changed = changed || wide != wide_before || high != high_before;
    wide_before = wide;
    high_before = high;
    uint64_t now_ns = mu_clock_ns();
    bool due = now_ns - top.shown_ns >= (uint64_t)(set.every_s * 1e9);
    if (changed || (due && (top.news || top.shown_ns == 0))) {
        screen_draw();
        top.shown_ns = now_ns;
    }
    return true;
}

/* --- rounds ----------------------------------------------------------------------------------- */

static int end_exit(void)
{
    return top.end == MU_RUN_DONE    ? MU_EXIT_DONE
           : top.end == MU_RUN_FAULT ? MU_EXIT_CRASH
                                     : MU_EXIT_DDS;
}

static void wait_round(void)
{
    struct pollfd fds[2] = {{.fd = mu_watch_wake_fd(top.watch), .events = POLLIN},
                            {.fd = STDIN_FILENO, .events = POLLIN}};
    (void)poll(fds, top.screen ? 2 : 1, ROUND_MS);
}

/* @return the exit code */
static int screen_run(void)
{
    bool goes_on = true;
    while (goes_on && !signal_came) {
        wait_round();
        mu_result spun = mu_watch_spin(top.watch, 0);
        if (spun < 0) {
            return mu_exit_for(spun);
        }
        goes_on = screen_round();
    }
    return signal_came == SIGINT ? MU_EXIT_INTERRUPTED : MU_EXIT_DONE;
}

/* @return the exit code */
static int lines_run(void)
{
    uint64_t until_ns = mu_clock_ns() + ONCE_PATIENCE_NS;
    while (!top.ended && !signal_came && !ferror(stdout)) {
        wait_round();
        mu_result spun = mu_watch_spin(top.watch, 0);
        uint64_t now_ns = mu_clock_ns();
        if (spun < 0 || (set.once && !top.news && !top.ended && now_ns > until_ns)) {
            fprintf(stderr, "muster top: no run in domain %d; muster run FILE starts one\n",
                    top.domain);
            return spun < 0 ? mu_exit_for(spun) : MU_EXIT_DDS;
        }
        if (top.news && !top.ended && now_ns - top.shown_ns >= (uint64_t)(set.every_s * 1e9)) {
            table_print();
            top.shown_ns = now_ns;
            if (set.once) {
                return MU_EXIT_DONE;
            }
        }
    }
    return signal_came ? MU_EXIT_INTERRUPTED : end_exit();
}

/* --- the verb --------------------------------------------------------------------------------- */

static struct mu_option option_table[] = {
    MU_NETWORK_OPTIONS(set.network),
    MU_STRING("sort", "KEY", set.sort,
              "name, state, distance, speed, stalls, stalled, explored, nearest, sent, received, "
              "fired, mean, efficiency, goal, x, y",
              .fallback = "name"),
    MU_REAL("every", "S", set.every_s, "seconds of wall time between two tables", .fallback = "1",
            .min = 0.05, .max = 3600),
    MU_FLAG("once", set.once, "one table, and end"),
    MU_LIST("goal", "NAME=X,Y[,NEAR]", set.goals,
            "where a robot is to go (m): how long it takes there is shown"),
    MU_FLAG("json", set.json,
            "one object a line: each robot and agent at each update, and the end"),
};

static mu_result settings_check(void)
{
    char name[MU_NAME_MAX + 1];
    double at[3];
    top.column = top_table_key(set.sort);
    if (top.column < 0) {
        char shown[MU_TEXT_SHOWN], keys[256];
        struct mu_text t = mu_text_in(keys, sizeof keys);
        top_table_keys(&t);
        fprintf(stderr, "muster top --sort %s: expected one of %s\n", mu_text_show(shown, set.sort),
                keys);
        return MU_FAULT_USAGE;
    }
    for (size_t i = 0; i < set.goals.count; i++) {
        if (!goal_read(set.goals.items[i], name, at)) {
            fprintf(stderr, "muster top --goal: expected NAME=X,Y or NAME=X,Y,NEAR in metres\n");
            return MU_FAULT_USAGE;
        }
    }
    return MU_OK;
}

static mu_result watch_open(void)
{
    struct mu_watch_options options = {
        .domain = top.domain,
        .interface = set.network.interface,
        .peer = mu_network_peers(&set.network),
        .handlers = {.on_scene = on_scene, .on_step = on_step, .on_end = on_end}};
    top.stats = mu_stats_open();
    MU_TRY(mu_watch_open(&top.watch, NULL, &options));
    mu_memory_seal();
    return MU_OK;
}

static int top_run(void)
{
    struct sigaction note = {.sa_handler = signal_note};
    sigaction(SIGINT, &note, NULL);
    sigaction(SIGTERM, &note, NULL);
    sigaction(SIGHUP, &note, NULL);
    top.screen = !set.json && !set.once && top_screen_open();
    int code = top.screen ? screen_run() : lines_run();
    top_screen_close();
    mu_watch_close(top.watch);
    return code;
}

int top_verb(int argc, char **argv)
{
    static struct mu_options o = {
        .program = "muster top",
        .usage = "[OPTION...]",
        .about = "Shows what a run amounts to while it goes on, a line for each robot and agent.  "
                 "On a terminal s sorts, arrows move, q ends.  It changes nothing in the run.",
        MU_OPTION_TABLE(option_table),
        .no_words = true};
    set.network.domain = -1;
    mu_result parsed = mu_options_parse(&o, argc, argv);
    parsed = parsed == MU_OK ? settings_check() : parsed;
    if (parsed != MU_OK) {
        return mu_exit_for(parsed);
    }
    top.domain = (int)set.network.domain;
    if (top.domain < 0 && runs_find(&top.domain) != MU_OK) {
        return MU_EXIT_SEVERAL;
    }
    mu_result opened = watch_open();
    return opened == MU_OK ? top_run() : mu_exit_for(opened);
}
