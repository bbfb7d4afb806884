/* SPDX-License-Identifier: Apache-2.0 */
#include "report/compare/compare.h"
#include "suite.h"

#include <CUnit/Basic.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { FOLDERS = 80 };

static char base[] = "/tmp/muster-compare-XXXXXX";
static char folders[FOLDERS][64];
static struct mu_fault fault;
static char text[1 << 18];

/* A summary with two robots, of which red went so far. */
static const char summary[] =
    "{\"experiment\": \"%s\", \"seed\": %d, \"hash\": \"%s\", \"overrides\": [\"%s\"],\n"
    " \"robots\": [{\"name\": \"red\", \"distance_m\": %g, \"final\": {\"x_m\": -1}},\n"
    "  {\"name\": \"blue\", \"distance_m\": 2}],\n"
    " \"explored_fraction\": 0.25, \"mail\": {\"sent\": 7},\n"
    " \"expectations\": [{\"text\": \"x\", \"met\": true}, {\"text\": \"y\", \"met\": %s}]}\n";

struct said {
    const char *experiment, *hash, *override;
    int seed;
    double red_m;
    bool met;
};

static void file_write(int folder, const char *content)
{
    char path[128];
    snprintf(folders[folder], sizeof folders[0], "%s/%d", base, folder);
    (void)mkdir(folders[folder], 0700);
    snprintf(path, sizeof path, "%s/summary.json", folders[folder]);
    FILE *file = fopen(path, "w");
    CU_ASSERT_FATAL(file && fputs(content, file) >= 0 && fclose(file) == 0);
}

static void run_write(int folder, const struct said *s)
{
    snprintf(text, sizeof text, summary, s->experiment, s->seed, s->hash,
             s->override ? s->override : "", s->red_m, s->met ? "true" : "false");
    file_write(folder, text);
}

static struct compare *compare_of(int count, const char *by, const char *const *names, size_t n)
{
    struct compare *c;
    CU_ASSERT_EQUAL_FATAL(compare_open(&c, (unsigned)count, by, names, n), MU_OK);
    for (int i = 0; i < count; i++) {
        CU_ASSERT_EQUAL(compare_add(c, folders[i], &fault), MU_OK);
    }
    CU_ASSERT_EQUAL(compare_close(c), MU_OK);
    return c;
}

static void test_statistics(void)
{
    static const char *const names[] = {
        "red.distance_m", "robots.distance_m", "red.final.x_m",   "explored_fraction",
        "mail.sent",      "expectations.met",  "green.distance_m"};
    static const double means[] = {5, 3.5, -1, 0.25, 7, 0.75};
    run_write(0, &(struct said){"follow", "aa", NULL, 1, 4, true});
    run_write(1, &(struct said){"follow", "bb", NULL, 2, 6, false});
    const struct compare *c = compare_of(2, NULL, names, 7);
    CU_ASSERT_EQUAL_FATAL(c->groups_count, 1);
    READS(c->groups[0].name, "follow");
    CU_ASSERT_EQUAL(c->groups[0].as_expected, 1);
    for (unsigned i = 0; i < 6; i++) {
        CU_ASSERT_EQUAL(c->groups[0].statistics[i].count, 2);
        CU_ASSERT_DOUBLE_EQUAL(c->groups[0].statistics[i].mean, means[i], 1e-12);
    }
    CU_ASSERT_DOUBLE_EQUAL(interval_half_width(&c->groups[0].statistics[0]), 12.7062, 1e-4);
    CU_ASSERT(!compare_has(c, 6));
}

static void test_groups(void)
{
    static const char *const names[] = {"red.distance_m"};
    static const char *const speeds[] = {"speed=10", "speed=9", "speed=10", "other=1"};
    static const char *const hashes[] = {"aa", "bb", "cc", "dd"};
    for (int i = 0; i < 4; i++) {
        run_write(i, &(struct said){"follow", hashes[i], speeds[i], i, i, true});
    }
    const struct compare *c = compare_of(4, "speed", names, 1);
    CU_ASSERT_EQUAL_FATAL(c->groups_count, 3);
    READS(c->groups[0].name, "9"); /* numbers go up */
    READS(c->groups[1].name, "10");
    READS(c->groups[2].name, "-");
    CU_ASSERT_EQUAL(c->groups[1].runs, 2);
    CU_ASSERT_DOUBLE_EQUAL(c->groups[1].statistics[0].mean, 1, 0);
    run_write(3, &(struct said){"patrol", "ee", "speed=9", 1, 1, true});
    c = compare_of(4, "speed", names, 1);
    READS(c->groups[0].name, "follow 10");
    READS(c->groups[2].name, "patrol 9");
}

static void test_one_run_counts_once(void)
{
    struct compare *c;
    run_write(0, &(struct said){"follow", "aa", NULL, 1, 1, true});
    run_write(1, &(struct said){"follow", "aa", NULL, 1, 1, true});
    run_write(2, &(struct said){"follow", "aa", NULL, 2, 1, true}); /* chance played no part */
    run_write(3, &(struct said){"follow", "none", NULL, 1, 1, true});
    run_write(4, &(struct said){"follow", "none", NULL, 1, 1, true});
    CU_ASSERT_EQUAL_FATAL(compare_open(&c, 5, NULL, NULL, 0), MU_OK);
    static const mu_result want[] = {MU_OK, MU_DUPLICATE, MU_OK, MU_OK, MU_OK};
    for (int i = 0; i < 5; i++) {
        CU_ASSERT_EQUAL(compare_add(c, folders[i], &fault), want[i]);
    }
    CU_ASSERT_EQUAL(c->runs_count, 4);
    CU_ASSERT_EQUAL(compare_add(c, folders[0], &fault), MU_DUPLICATE);
}

static void test_faults(void)
{
    struct compare *c;
    CU_ASSERT_EQUAL_FATAL(compare_open(&c, 2, NULL, NULL, 0), MU_OK);
    CU_ASSERT_EQUAL(compare_add(c, "/nowhere", &fault), MU_FAULT_FILE);
    READS(fault.file, "/nowhere/summary.json");
    file_write(0, "{\"experiment\": \"a\",\n \"seed\" 1}");
    CU_ASSERT_EQUAL(compare_add(c, folders[0], &fault), MU_FAULT_FILE);
    CU_ASSERT(fault.line == 2 && fault.column == 9);
    file_write(0, "[1, 2]");
    CU_ASSERT_EQUAL(compare_add(c, folders[0], &fault), MU_FAULT_FILE);
    READS(fault.text, "expected the summary of a run");
    CU_ASSERT_EQUAL(c->runs_count, 0);
}

static void page_of(const struct compare *c)
{
    char path[128];
    snprintf(path, sizeof path, "%s/page.html", base);
    CU_ASSERT_EQUAL_FATAL(compare_page(c, path, &fault), MU_OK);
    FILE *file = fopen(path, "r");
    CU_ASSERT_FATAL(file != NULL);
    text[fread(text, 1, sizeof text - 1, file)] = '\0';
    fclose(file);
    unlink(path);
}

static void test_names_cannot_break_a_page(void)
{
    run_write(0, &(struct said){"<script>alert(1)</script>", "aa", NULL, 1, 1, true});
    run_write(1, &(struct said){"a\\u0007\\u001b[2J\\\"'&", "bb", NULL, 1, 2, true});
    const struct compare *c = compare_of(2, NULL, NULL, 0);
    page_of(c);
    CU_ASSERT_PTR_NULL(strstr(text, "<script"));
    CU_ASSERT_PTR_NOT_NULL(strstr(text, "&lt;script&gt;alert(1)"));
    CU_ASSERT_PTR_NULL(strchr(text, '\a'));
    CU_ASSERT_PTR_NULL(strchr(text, '\x1b'));
    FILE *file = fmemopen(text, sizeof text, "w");
    compare_print(c, file, false);
    fclose(file);
    CU_ASSERT_PTR_NULL(strchr(text, '\x1b'));
}

/* One run has no interval; equal ones have one of no width. */
static void test_pages_of_few_runs(void)
{
    run_write(0, &(struct said){"follow", "aa", NULL, 1, 1, true});
    page_of(compare_of(1, NULL, NULL, 0));
    CU_ASSERT_PTR_NULL(strstr(text, "nan"));
    CU_ASSERT_PTR_NULL(strstr(text, "inf\""));
    run_write(1, &(struct said){"follow", "bb", NULL, 2, 1, true});
    page_of(compare_of(2, NULL, NULL, 0));
    CU_ASSERT_PTR_NULL(strstr(text, "nan"));
    page_of(compare_of(0, NULL, NULL, 0));
    CU_ASSERT_PTR_NOT_NULL(strstr(text, "</html>"));
}

static void test_labels(void)
{
    char label[COMPARE_NAME_MAX + 16];
    compare_label(label, "robots.mean_speed_m_s");
    READS(label, "robots: mean speed (m/s)");
    compare_label(label, "explored_fraction");
    READS(label, "explored (of 1)");
    compare_label(label, "red.final.heading_rad");
    READS(label, "red: final heading (rad)");
    compare_label(label, "mail.sent");
    READS(label, "mail: sent");
}

static void test_limits(void)
{
    struct compare *c;
    char long_name[COMPARE_NAME_MAX + 1];
    memset(long_name, 'x', sizeof long_name - 1);
    long_name[sizeof long_name - 1] = '\0';
    const char *names[COMPARE_STATISTICS_MAX + 1] = {long_name};
    CU_ASSERT_EQUAL(compare_open(&c, 1, NULL, names, 1), MU_FAULT_USAGE);
    for (size_t i = 0; i <= COMPARE_STATISTICS_MAX; i++) {
        names[i] = "mail.sent";
    }
    CU_ASSERT_EQUAL(compare_open(&c, 1, NULL, names, COMPARE_STATISTICS_MAX), MU_OK);
    CU_ASSERT_EQUAL(compare_open(&c, 1, NULL, names, COMPARE_STATISTICS_MAX + 1), MU_FAULT_USAGE);
    CU_ASSERT_EQUAL_FATAL(compare_open(&c, COMPARE_GROUPS_MAX + 1, NULL, NULL, 0), MU_OK);
    for (int i = 0; i <= COMPARE_GROUPS_MAX; i++) {
        char name[16], hash[16];
        snprintf(name, sizeof name, "e%d", i);
        snprintf(hash, sizeof hash, "h%d", i);
        run_write(i, &(struct said){name, hash, NULL, 1, 1, true});
        CU_ASSERT_EQUAL(compare_add(c, folders[i], &fault), MU_OK);
    }
    CU_ASSERT_EQUAL(compare_add(c, folders[0], &fault), MU_FULL);
    CU_ASSERT_EQUAL(compare_close(c), MU_FULL);
}

static int base_make(void)
{
    return mkdtemp(base) ? 0 : 1;
}

static int base_remove(void)
{
    char command[96];
    snprintf(command, sizeof command, "rm -r %s", base);
    return system(command);
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"statistics", test_statistics},
        {"groups", test_groups},
        {"one run counts once", test_one_run_counts_once},
        {"faults", test_faults},
        {"names cannot break a page", test_names_cannot_break_a_page},
        {"pages of few runs", test_pages_of_few_runs},
        {"labels", test_labels},
        {"limits", test_limits},
        CU_TEST_INFO_NULL,
    };
    CU_SuiteInfo suites[] = {{"report/compare", base_make, base_remove, NULL, NULL, tests},
                             CU_SUITE_INFO_NULL};
    return suites_run(suites);
}
