/* SPDX-License-Identifier: Apache-2.0 */
#include "capture.h"
#include "sim/record/record.h"
#include "suite.h"

#include <CUnit/Basic.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char head[] = "time_s,robot,x_m,y_m,heading_rad,forward_m_s,turn_rad_s,stalled\n";
static char folder[] = "/tmp/muster-tracks-XXXXXX";
static char path[64];
static char text[1 << 16];

static int folder_make(void)
{
    if (!mkdtemp(folder)) {
        return 1;
    }
    snprintf(path, sizeof path, "%s/run.csv", folder);
    return 0;
}

static int folder_remove(void)
{
    return rmdir(folder);
}

static struct tracks *open_at(const char *where)
{
    static struct tracks *all[8]; /* kept, so that leak checkers see them */
    static unsigned count;
    struct tracks **r = &all[count++ % 8];
    CU_ASSERT_EQUAL_FATAL(tracks_open(r, where), MU_OK);
    return *r;
}

/* Reads the record back, without its head. */
static const char *rows(void)
{
    FILE *file = fopen(path, "r");
    CU_ASSERT_PTR_NOT_NULL_FATAL(file);
    text[fread(text, 1, sizeof text - 1, file)] = '\0';
    fclose(file);
    CU_ASSERT_EQUAL(remove(path), 0);
    CU_ASSERT_EQUAL_FATAL(strncmp(text, head, strlen(head)), 0);
    return text + strlen(head);
}

static void test_an_empty_record_has_its_head(void)
{
    CU_ASSERT_EQUAL(tracks_close(open_at(path)), MU_OK);
    CU_ASSERT_STRING_EQUAL(rows(), "");
}

static void test_rows(void)
{
    struct tracks *r = open_at(path);
    struct engine_sample p = {
        .pose = {1.5, -2.25, 0.125}, .percept.forward_m_s = 0.3, .percept.turn_rad_s = -1};
    tracks_add(r, 0, "red", &p);
    p.percept.stalled = true;
    tracks_add(r, 100000000, "a-name-of-31-bytes-is-the-limit", &p);
    CU_ASSERT_EQUAL(tracks_close(r), MU_OK);
    CU_ASSERT_STRING_EQUAL(
        rows(), "0.000000,red,1.500000,-2.250000,0.125000,0.300000,-1.000000,0\n"
                "0.100000,a-name-of-31-bytes-is-the-limit,1.500000,-2.250000,0.125000,0.300000,"
                "-1.000000,1\n");
}

static void test_numbers(void)
{
    static const struct {
        double value;
        const char *want;
    } cases[] = {
        {0.0, "0.000000"},
        {-0.0, "0.000000"},
        {1e-6, "0.000001"},
        {-1e-6, "-0.000001"},
        {4e-7, "0.000000"},
        {-4e-7, "0.000000"}, /* not "-0.000000" */
        {6e-7, "0.000001"},
        {-6e-7, "-0.000001"},
        {0.9999994, "0.999999"},
        {0.9999996, "1.000000"},
        {-0.9999996, "-1.000000"},
        {0.1, "0.100000"},
        {0.000123, "0.000123"},
        {9.9999999, "10.000000"},
        {10.0, "10.000000"},
        {-123456.789012, "-123456.789012"},
        {1e9, "1000000000.000000"},
        {-4294967296.5, "-4294967296.500000"},
        {9e12, "9000000000000.000000"},
        {5e-324, "0.000000"},
    };
    enum { CASES = sizeof cases / sizeof cases[0] };
    struct tracks *r = open_at(path);
    for (size_t i = 0; i < CASES; i++) {
        double v = cases[i].value;
        struct engine_sample p = {.pose = {v, 0, v}, .percept.turn_rad_s = v};
        tracks_add(r, 0, "red", &p);
    }
    CU_ASSERT_EQUAL(tracks_close(r), MU_OK);
    const char *row = rows();
    for (size_t i = 0; i < CASES; i++) {
        char want[256];
        const char *number = cases[i].want;
        int len = snprintf(want, sizeof want, "0.000000,red,%s,0.000000,%s,0.000000,%s,0\n", number,
                           number, number);
        CU_ASSERT_EQUAL(strncmp(row, want, (size_t)len), 0);
        row = strchr(row, '\n') + 1;
    }
    CU_ASSERT_STRING_EQUAL(row, "");
}

/* As printf has it, wherever a value is no tie. */
static void test_numbers_as_printf(void)
{
    enum { FROM = -300, TO = 300 };
    struct tracks *r = open_at(path);
    for (int i = FROM; i <= TO; i++) {
        struct engine_sample p = {.pose = {0, i * 0.370370371 + i * i * 1.1e-5, 0}};
        tracks_add(r, (uint64_t)(i - FROM) * 123456789u, "b", &p);
    }
    CU_ASSERT_EQUAL(tracks_close(r), MU_OK);
    const char *row = rows();
    for (int i = FROM; i <= TO; i++) {
        char want[256];
        int len = snprintf(want, sizeof want, "%.6f,b,0.000000,%.6f,0.000000,0.000000,0.000000,0\n",
                           (double)((uint64_t)(i - FROM) * 123456789u) * 1e-9,
                           i * 0.370370371 + i * i * 1.1e-5);
        CU_ASSERT_EQUAL(strncmp(row, want, (size_t)len), 0);
        row = strchr(row, '\n') + 1;
    }
}

/* Nothing finite is too large for a row: what comes out is a number, if not the right one. */
static void test_limit_numbers(void)
{
    static const double values[] = {1e13, -1e13, 1e300, -1e300};
    struct tracks *r = open_at(path);
    for (size_t i = 0; i < 4; i++) {
        double v = values[i];
        struct engine_sample p = {
            .pose = {v, v, v}, .percept.forward_m_s = v, .percept.turn_rad_s = v};
        tracks_add(r, UINT64_MAX, "a-name-of-31-bytes-is-the-limit", &p);
    }
    CU_ASSERT_EQUAL(tracks_close(r), MU_OK);
    const char *at = rows();
    unsigned commas = 0;
    CU_ASSERT_EQUAL(strncmp(at, "18446744073.709", 15), 0);
    for (; *at; at++) {
        commas += *at == ',';
    }
    CU_ASSERT_EQUAL(commas, 4 * 7);
}

static void test_a_full_disk_shows_at_the_close(void)
{
    struct engine_sample p = {.pose = {1, 2, 3}};
    struct tracks *little = open_at("/dev/full");
    capture_begin();
    tracks_add(little, 0, "red", &p);
    mu_result little_closed = tracks_close(little);
    capture_end();
    CU_ASSERT_EQUAL(little_closed, MU_FAULT_OS);
    CU_ASSERT(said("cannot write /dev/full: No space left on device"));

    struct tracks *much = open_at("/dev/full");
    capture_begin();
    for (int i = 0; i < 10000; i++) { /* more than the buffer holds */
        tracks_add(much, 0, "red", &p);
    }
    mu_result much_closed = tracks_close(much);
    capture_end();
    CU_ASSERT_EQUAL(much_closed, MU_FAULT_OS);
    CU_ASSERT(said("cannot write /dev/full: "));
}

static void test_a_folder_that_is_not_there(void)
{
    struct tracks *r = NULL;
    capture_begin();
    mu_result opened = tracks_open(&r, "/tmp/muster-nowhere/run.csv");
    capture_end();
    CU_ASSERT_EQUAL(opened, MU_FAULT_OS);
    CU_ASSERT_PTR_NULL(r);
    CU_ASSERT(said("cannot create /tmp/muster-nowhere/run.csv: No such file or directory"));
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"an empty record", test_an_empty_record_has_its_head},
        {"rows", test_rows},
        {"numbers", test_numbers},
        {"numbers as printf has them", test_numbers_as_printf},
        {"limit: numbers", test_limit_numbers},
        {"a full disk shows at the close", test_a_full_disk_shows_at_the_close},
        {"a folder that is not there", test_a_folder_that_is_not_there},
        CU_TEST_INFO_NULL,
    };
    CU_SuiteInfo suites[] = {{"sim/tracks", folder_make, folder_remove, NULL, NULL, tests},
                             CU_SUITE_INFO_NULL};
    return suites_run(suites);
}
