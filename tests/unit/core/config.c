/* SPDX-License-Identifier: Apache-2.0 */
/* The configuration file beyond test_core_options.c: where it is, its limits, and garbage in it. */
#include "capture.h"
#include "core/options.h"
#include "garble.h"
#include "suite.h"

#include <CUnit/Basic.h>
#include <math.h>
#include <stdlib.h>
#include <sys/stat.h>

static char folder[] = "/tmp/muster-config-XXXXXX";
static char config[128];

static bool quiet;
static const char *out;
static int64_t seed, once;
static double rate;
static struct mu_option_list set;
static struct mu_option table[6];
static struct mu_options options;

static void begin(void)
{
    const struct mu_option fresh[] = {
        {.name = "quiet", .kind = MU_OPTION_FLAG, .environment = "Q", .target = &quiet},
        {.name = "out", .kind = MU_OPTION_STRING, .environment = "O", .target = &out},
        {.name = "seed",
         .kind = MU_OPTION_INTEGER,
         .environment = "S",
         .target = &seed,
         .max = 1000},
        {.name = "rate", .kind = MU_OPTION_REAL, .environment = "R", .target = &rate, .max = 100},
        {.name = "set", .kind = MU_OPTION_LIST, .environment = "L", .target = &set},
        {.name = "once", .kind = MU_OPTION_INTEGER, .target = &once, .max = 1000},
    };
    memcpy(table, fresh, sizeof table);
    quiet = false;
    out = NULL;
    seed = 1;
    once = 1;
    rate = 0.5;
    set.count = 0;
    options = (struct mu_options){.program = "muster test", .table = table, .count = 6};
}

static void config_write(const char *text, size_t len)
{
    FILE *file = fopen(config, "w");
    CU_ASSERT_PTR_NOT_NULL_FATAL(file);
    CU_ASSERT_EQUAL(fwrite(text, 1, len, file), len);
    CU_ASSERT_EQUAL(fclose(file), 0);
}

static mu_result read_config(const char *path)
{
    begin();
    capture_begin();
    mu_result result = mu_options_read_config(&options, path);
    capture_end();
    return result;
}

static void test_the_usual_places(void)
{
    static const char text[] = "seed = 42\n";
    char inner[64];
    snprintf(inner, sizeof inner, "%s/.config", folder);
    CU_ASSERT_EQUAL(mkdir(inner, 0700), 0);
    snprintf(inner, sizeof inner, "%s/.config/muster", folder);
    CU_ASSERT_EQUAL(mkdir(inner, 0700), 0);
    char kept[sizeof config];
    memcpy(kept, config, sizeof kept);
    snprintf(config, sizeof config, "%s/config", inner);
    config_write(text, sizeof text - 1);
    setenv("HOME", folder, 1);
    unsetenv("XDG_CONFIG_HOME");
    CU_ASSERT_EQUAL(read_config(NULL), MU_OK);
    CU_ASSERT_EQUAL(seed, 42);
    setenv("XDG_CONFIG_HOME", "/nowhere/at/all", 1);
    CU_ASSERT_EQUAL(read_config(NULL), MU_OK); /* XDG's comes first, and need not exist */
    CU_ASSERT_EQUAL(seed, 1);
    setenv("XDG_CONFIG_HOME", "", 1);
    CU_ASSERT_EQUAL(read_config(NULL), MU_OK);
    CU_ASSERT_EQUAL(seed, 42);
    setenv("HOME", "", 1);
    CU_ASSERT_EQUAL(read_config(NULL), MU_OK);
    CU_ASSERT_EQUAL(seed, 1);
    CU_ASSERT_EQUAL(remove(config), 0);
    CU_ASSERT_EQUAL(rmdir(inner), 0);
    snprintf(inner, sizeof inner, "%s/.config", folder);
    CU_ASSERT_EQUAL(rmdir(inner), 0);
    memcpy(config, kept, sizeof config);
}

static void test_a_file_that_is_named_must_be_there(void)
{
    CU_ASSERT_EQUAL(read_config("/nowhere/config"), MU_FAULT_FILE);
    CU_ASSERT(said("/nowhere/config: cannot read the configuration file: No such file"));
    setenv("MUSTER_CONFIG", "/nowhere/either", 1);
    CU_ASSERT_EQUAL(read_config(NULL), MU_FAULT_FILE);
    CU_ASSERT(said("/nowhere/either: "));
    unsetenv("MUSTER_CONFIG");
}

static void test_limit_lines(void)
{
    static char text[1 << 14];
    memset(text, 'x', sizeof text);
    config_write(text, sizeof text);
    CU_ASSERT_EQUAL(read_config(config), MU_FAULT_FILE);
    CU_ASSERT(said("/config:1: expected a line of less than "));
    memset(text, '\n', sizeof text);
    config_write(text, sizeof text);
    CU_ASSERT_EQUAL(read_config(config), MU_OK);
}

static void test_limit_items_in_a_list(void)
{
    static char text[2 * (MU_OPTION_LIST_MAX + 1)];
    char why[MU_OPTION_WHY_MAX] = "";
    char want[32];
    for (int i = 0; i <= MU_OPTION_LIST_MAX; i++) {
        memcpy(text + 2 * i, "a,", 2);
    }
    begin();
    struct mu_option *option = mu_options_find(&options, "set");
    option->source = MU_OPTION_CONFIG;
    text[2 * MU_OPTION_LIST_MAX - 1] = '\0';
    CU_ASSERT_TRUE(mu_option_set(option, text, why));
    CU_ASSERT_EQUAL(set.count, MU_OPTION_LIST_MAX);
    text[2 * MU_OPTION_LIST_MAX - 1] = ',';
    text[2 * MU_OPTION_LIST_MAX + 1] = '\0';
    CU_ASSERT_FALSE(mu_option_set(option, text, why));
    snprintf(want, sizeof want, "more than %d of them", MU_OPTION_LIST_MAX);
    CU_ASSERT_STRING_EQUAL(why, want);
}

static void test_numbers_out_of_range(void)
{
    static const char *const bad[] = {"seed = 99999999999999999999\n",
                                      "seed = -1\n",
                                      "seed = 1001\n",
                                      "seed = 1 2\n",
                                      "seed =\n",
                                      "rate = -0.1\n",
                                      "rate = 100.1\n",
                                      "rate = nan\n",
                                      "rate = inf\n",
                                      "rate = 1e999\n",
                                      "rate = 1x\n",
                                      "quiet = maybe\n"};
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        config_write(bad[i], strlen(bad[i]));
        CU_ASSERT_EQUAL(read_config(config), MU_FAULT_FILE);
        CU_ASSERT(said("/config:1: "));
        CU_ASSERT_EQUAL(seed, 1);
    }
}

/* Only what has an environment variable can be configured; the rest is for the command line. */
static void test_other_options_are_passed_by(void)
{
    static const char text[] = "once = 7\nonce = x\nno-such = 1\nseed = 5\n";
    config_write(text, sizeof text - 1);
    CU_ASSERT_EQUAL(read_config(config), MU_OK);
    CU_ASSERT_EQUAL(once, 1);
    CU_ASSERT_EQUAL(seed, 5);
}

/* Garbage is refused with its place, or read; what is read keeps its range. */
static void test_garbage_is_refused_or_read(void)
{
    enum { SEED = 21, ROUNDS = 3000 };
    static const char sample[] = "# a comment\nseed = 42\n\nrate = 1.5 # more\nquiet = yes\n"
                                 "out = /tmp/a b\nset = a=1, b=2,c=3\n";
    struct mu_random r;
    unsigned counts[2] = {0};
    unsigned wrong = 0;
    mu_random_seed(&r, SEED, "config");
    printf("seed %d ", SEED);
    for (int round = 0; round < ROUNDS; round++) {
        char text[512];
        size_t len = garble(&r, text, sizeof text, sample, sizeof sample - 1);
        config_write(text, len);
        mu_result first = read_config(config);
        char words[sizeof captured];
        memcpy(words, captured, sizeof words);
        mu_result second = read_config(config);
        bool whole = seed >= 0 && seed <= 1000 && isfinite(rate) && rate >= 0 && rate <= 100 &&
                     set.count <= MU_OPTION_LIST_MAX;
        bool known = first == MU_OK || (first == MU_FAULT_FILE && said("/config:"));
        wrong += !whole || !known || first != second || strcmp(words, captured) != 0;
        counts[first == MU_OK]++;
    }
    CU_ASSERT_EQUAL(wrong, 0);
    CU_ASSERT(counts[0] > ROUNDS / 10 && counts[1] > ROUNDS / 10);
}

static int folder_make(void)
{
    unsetenv("MUSTER_CONFIG");
    if (!mkdtemp(folder)) {
        return 1;
    }
    snprintf(config, sizeof config, "%s/config", folder);
    return 0;
}

static int folder_remove(void)
{
    return remove(config) || rmdir(folder);
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"the usual places", test_the_usual_places},
        {"a file that is named must be there", test_a_file_that_is_named_must_be_there},
        {"limit: lines", test_limit_lines},
        {"limit: items in a list", test_limit_items_in_a_list},
        {"numbers out of range", test_numbers_out_of_range},
        {"other options are passed by", test_other_options_are_passed_by},
        {"garbage is refused or read", test_garbage_is_refused_or_read},
        CU_TEST_INFO_NULL,
    };
    CU_SuiteInfo suites[] = {{"core/config", folder_make, folder_remove, NULL, NULL, tests},
                             CU_SUITE_INFO_NULL};
    return suites_run(suites);
}
