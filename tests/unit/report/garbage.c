/* SPDX-License-Identifier: Apache-2.0 */
/* Experiments, overrides and records that are damaged: refused with their place, or read. */
#include "experiment/experiment.h"
#include "garble.h"
#include "report/compare/compare.h"
#include "report/report_data.h"
#include "suite.h"

#include <CUnit/Basic.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

static char folder[] = "/tmp/muster-garbage-XXXXXX";
static char yaml[64], csv[64], json[64];

static bool file_written(const char *path, const char *text, size_t len)
{
    FILE *file = fopen(path, "w");
    bool written = file && fwrite(text, 1, len, file) == len;
    return file && fclose(file) == 0 && written;
}

static void file_write(const char *path, const char *text, size_t len)
{
    CU_ASSERT_TRUE_FATAL(file_written(path, text, len));
}

static const char experiment_sample[] =
    "name: follow\nworld: a.world\nseed: 3\nduration: 120\nstep_ms: 100\non-crash: stop\n"
    "robots:\n  - {name: red, rules: a.clp, globals: {mate: blue, n: 2}}\n"
    "  - name: blue\n    rules: a.clp\n    body: pioneer\n    color: '#00f'\n"
    "    pose: [1, -2.5, 90]\n"
    "observer:\n  - {at: 0, do: red, line: \"(wander)\"}\n"
    "  - {at: 60.5, do: [red, blue], line: \"(follow \\\"green\\\")\"}\n"
    "expect:\n  - {near: [blue, red], within: 2.5, from: 30, to: 60, share: 0.8}\n"
    "  - {inside: arena}\n  - {stall-max: 10}\n"
    "  - {statistic: red.distance_m, at_least: 5}\n"
    "  - {sequence: [red told x to all, red near blue 0.5], within_s: 3}\n"
    "  - {never: blue.stalled_s > 2}\n"
    "chaos:\n  - {at: 1, push: red, force: [1, -2], torque: 3, for: 0.5}\n"
    "  - {when: red at 1 2 3, place: blue, pose: [1, 2, 3]}\n"
    "  - {at: 2, block: red, sensor: sonar}\n  - {at: 2, kill: broker, for: 2}\n"
    "  - {at: 3, lose: [red, all], share: 0.1}\n  - {at: 4, delay: [red, blue], by_ms: 3}\n";

static bool experiment_whole(const struct experiment *e)
{
    bool whole = e->name && e->world && isfinite(e->duration) && e->duration > 0 &&
                 isfinite(e->step_ms) && e->step_ms > 0 && e->robots_count > 0;
    for (unsigned i = 0; i < e->robots_count; i++) {
        whole = whole && e->robots[i].name && e->robots[i].rules;
    }
    for (unsigned i = 0; i < e->chaos_count; i++) {
        whole = whole && e->chaos[i].kind != CHAOS_NONE && e->chaos[i].who && e->chaos[i].text[0];
    }
    for (unsigned i = 0; i < e->expect_count; i++) {
        for (unsigned k = 0; k < e->expect[i].sequence_count; k++) {
            whole = whole && experiment_event_find(e, e->expect[i].sequence[k]) < e->events_count;
        }
    }
    return whole;
}

static void test_experiments(void)
{
    enum { SEED = 41, ROUNDS = 1500 };
    static struct mu_fault first, second;
    static struct experiment *e;
    struct mu_random r;
    unsigned counts[2] = {0};
    unsigned wrong = 0;
    mu_random_seed(&r, SEED, "experiments");
    printf("seed %d ", SEED);
    for (int round = 0; round < ROUNDS; round++) {
        char text[2 * sizeof experiment_sample];
        size_t len = garble(&r, text, sizeof text, experiment_sample, sizeof experiment_sample - 1);
        file_write(yaml, text, len);
        mu_result loaded = experiment_load(&e, yaml, NULL, 0, &first);
        if (loaded == MU_OK) {
            wrong += !experiment_whole(e);
        } else {
            mu_result again = experiment_load(&e, yaml, NULL, 0, &second);
            wrong += loaded != MU_FAULT_FILE || again != loaded || first.text[0] == '\0' ||
                     strcmp(first.text, second.text) != 0 || first.line != second.line ||
                     strcmp(first.file, yaml) != 0;
        }
        counts[loaded == MU_OK]++;
    }
    CU_ASSERT_EQUAL(wrong, 0);
    CU_ASSERT(counts[0] > ROUNDS / 10 && counts[1] > ROUNDS / 500);
}

static void test_overrides(void)
{
    enum { SEED = 42, ROUNDS = 1500 };
    static const char *const sets[] = {"duration=30",
                                       "robots.red.rules=/tmp/x.clp",
                                       "seed=7",
                                       "robots.blue.color=#123",
                                       "robots.red.globals.mate=green",
                                       "on-crash=stop",
                                       "step_ms=50",
                                       "name=other"};
    enum { SETS = sizeof sets / sizeof sets[0] };
    static struct mu_fault fault;
    static struct experiment *e;
    struct mu_random r;
    unsigned counts[2] = {0};
    unsigned wrong = 0;
    mu_random_seed(&r, SEED, "overrides");
    printf("seed %d ", SEED);
    file_write(yaml, experiment_sample, sizeof experiment_sample - 1);
    for (int round = 0; round < ROUNDS; round++) {
        char text[128];
        const char *sample = sets[round % SETS];
        (void)garble(&r, text, sizeof text, sample, strlen(sample));
        const char *const set = text;
        mu_result loaded = experiment_load(&e, yaml, &set, 1, &fault);
        bool refused = loaded == MU_FAULT_USAGE || loaded == MU_FAULT_FILE;
        wrong += loaded == MU_OK ? !experiment_whole(e) : !refused || fault.text[0] == '\0';
        counts[loaded == MU_OK]++;
    }
    CU_ASSERT_EQUAL(wrong, 0);
    CU_ASSERT(counts[0] > ROUNDS / 10 && counts[1] > ROUNDS / 100);
}

static void test_records(void)
{
    enum { SEED = 43, ROUNDS = 2000 };
    static const char sample[] = "time_s,robot,x_m,y_m,heading_rad,forward_m_s,turn_rad_s,stalled\n"
                                 "0.000000,red,1.000000,2.000000,0.000000,0.000000,0.000000,0\n"
                                 "0.000000,blue,-1.000000,2.500000,3.141593,0.300000,-0.100000,1\n"
                                 "0.100000,red,1.000000,2.000000,0.000000,0.000000,0.000000,0\n"
                                 "0.100000,blue,-1.000000,2.500000,3.141593,0.300000,-0.100000,0\n";
    struct report_robot robots[] = {{.name = "red"}, {.name = "blue"}};
    struct report_input input = {.robots = robots, .robots_count = 2};
    static struct mu_fault fault;
    struct mu_random r;
    unsigned counts[2] = {0};
    unsigned wrong = 0;
    mu_random_seed(&r, SEED, "records");
    printf("seed %d ", SEED);
    for (int round = 0; round < ROUNDS; round++) {
        char text[2 * sizeof sample];
        struct report_reader reader;
        struct report_row row;
        size_t rows_max = 0;
        size_t rows = 0;
        file_write(csv, text, garble(&r, text, sizeof text, sample, sizeof sample - 1));
        mu_result read = report_reader_open(&reader, folder, &input, &rows_max, &fault);
        bool opened = read == MU_OK;
        while (read == MU_OK) {
            read = report_reader_next(&reader, &row, &fault);
            if (read == MU_OK) {
                rows++;
                wrong += row.robot >= 2 || !isfinite(row.time_s) || !isfinite(row.x_m) ||
                         !isfinite(row.y_m) || !isfinite(row.heading_rad);
            }
        }
        if (opened) {
            report_reader_close(&reader);
        }
        wrong += rows > rows_max || (read != MU_DONE && read != MU_FAULT_FILE) ||
                 (read == MU_FAULT_FILE && fault.text[0] == '\0');
        counts[read == MU_DONE]++;
    }
    CU_ASSERT_EQUAL(wrong, 0);
    CU_ASSERT(counts[0] > ROUNDS / 10 && counts[1] > ROUNDS / 100);
}

static void test_summaries(void)
{
    enum { SEED = 44, ROUNDS = 2000 };
    static const char sample[] =
        "{\"experiment\": \"follow\", \"seed\": 1, \"hash\": \"6f\", \"overrides\": [\"a=b\"],\n"
        "\"robots\": [{\"name\": \"red\", \"distance_m\": 2.5e1, \"final\": {\"x_m\": -1}}],\n"
        "\"mail\": {\"sent\": 7}, \"expectations\": [{\"text\": \"\\u00e9\\n\", \"met\": true}]}";
    static struct mu_fault fault;
    struct mu_random r;
    struct compare *c;
    unsigned counts[2] = {0}, wrong = 0;
    mu_random_seed(&r, SEED, "summaries");
    printf("seed %d ", SEED);
    CU_ASSERT_EQUAL_FATAL(compare_open(&c, 1, "a", NULL, 0), MU_OK);
    for (int round = 0; round < ROUNDS; round++) {
        char text[2 * sizeof sample];
        file_write(json, text, garble(&r, text, sizeof text, sample, sizeof sample - 1));
        c->runs_count = 0;
        mu_result added = compare_add(c, folder, &fault);
        wrong += added != MU_OK && (added != MU_FAULT_FILE || fault.text[0] == '\0');
        counts[added == MU_OK]++;
    }
    CU_ASSERT_EQUAL(wrong, 0);
    CU_ASSERT(counts[0] > ROUNDS / 10 && counts[1] > ROUNDS / 100);
}

static int begin(void)
{
    char file[64];
    if (!mkdtemp(folder)) {
        return 1;
    }
    snprintf(yaml, sizeof yaml, "%s/test.yaml", folder);
    snprintf(csv, sizeof csv, "%s/run.csv", folder);
    snprintf(json, sizeof json, "%s/summary.json", folder);
    const char *const others[] = {"a.world", "a.clp"};
    for (size_t i = 0; i < 2; i++) {
        snprintf(file, sizeof file, "%s/%s", folder, others[i]);
        if (!file_written(file, "", 0)) {
            return 1;
        }
    }
    return 0;
}

static int end(void)
{
    char file[64];
    const char *const files[] = {"a.world", "a.clp", "test.yaml", "run.csv", "summary.json"};
    for (size_t i = 0; i < 5; i++) {
        snprintf(file, sizeof file, "%s/%s", folder, files[i]);
        (void)unlink(file);
    }
    return rmdir(folder);
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"experiments", test_experiments},
        {"overrides", test_overrides},
        {"records", test_records},
        {"summaries", test_summaries},
        CU_TEST_INFO_NULL,
    };
    CU_SuiteInfo suites[] = {{"report: garbage", begin, end, NULL, NULL, tests},
                             CU_SUITE_INFO_NULL};
    return suites_run(suites);
}
