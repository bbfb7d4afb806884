/* SPDX-License-Identifier: Apache-2.0 */
#include "core/options.h"
#include "muster/version.h"
#include "suite.h"

#include <CUnit/Basic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static bool quiet;
static const char *out;
static int64_t seed;
static double rate;
static struct mu_option_list set;
static struct mu_option_list robots;
static const char *broker;

static struct mu_option table[] = {
    MU_FLAG("quiet", quiet, "no progress", .letter = 'q', .fallback = "no",
            .environment = "MUSTER_QUIET"),
    MU_STRING("out", "DIR", out, "where", .letter = 'o', .fallback = "out",
              .environment = "MUSTER_OUT"),
    MU_INTEGER("seed", "N", seed, "seed", .letter = 's', .fallback = "1",
               .environment = "MUSTER_SEED", .max = 1000),
    MU_REAL("rate", "R", rate, "pace", .fallback = "0", .environment = "MUSTER_RATE"),
    MU_LIST("set", "K=V", set, "override", .environment = "MUSTER_SET"),
    MU_NAMES("robots", "NAME", robots, "who"),
    MU_STRING("broker", "[NAME]", broker, "which", .fallback = "no", .alone = ""),
};

static struct mu_options options = {.program = "muster run",
                                    .usage = "FILE [OPTION...]",
                                    .about = "Runs an experiment.",
                                    MU_OPTION_TABLE(table)};

static char folder[] = "/tmp/muster-options-XXXXXX";
static char config[64];

/* Messages go to a file, so that a passing test is silent. */
static char messages[4096];

/* Parses a command line of words without quotes. */
static mu_result parse(const char *line)
{
    static char words[16384];
    static char *argv[2 * MU_OPTION_LIST_MAX + 16];
    int argc = 0;
    CU_ASSERT_FATAL((size_t)snprintf(words, sizeof words, "run %s", line) < sizeof words);
    char *rest = words;
    while ((argv[argc] = strsep(&rest, " ")) != NULL) {
        argc++;
    }
    fflush(stdout);
    fflush(stderr);
    FILE *caught = tmpfile();
    CU_ASSERT_PTR_NOT_NULL_FATAL(caught);
    int saved_out = dup(STDOUT_FILENO);
    int saved_err = dup(STDERR_FILENO);
    dup2(fileno(caught), STDOUT_FILENO);
    dup2(fileno(caught), STDERR_FILENO);
    mu_result result = mu_options_parse(&options, argc, argv);
    fflush(stdout);
    fflush(stderr);
    dup2(saved_out, STDOUT_FILENO);
    dup2(saved_err, STDERR_FILENO);
    close(saved_out);
    close(saved_err);
    rewind(caught);
    messages[fread(messages, 1, sizeof messages - 1, caught)] = '\0';
    fclose(caught);
    return result;
}

static mu_result parse_with_config(void)
{
    char line[80];
    snprintf(line, sizeof line, "--config %s", config);
    return parse(line);
}

static bool said(const char *words)
{
    return strstr(messages, words) != NULL;
}

static void config_write(const char *text)
{
    FILE *file = fopen(config, "w");
    CU_ASSERT_PTR_NOT_NULL_FATAL(file);
    fputs(text, file);
    CU_ASSERT_EQUAL(fclose(file), 0);
}

static void test_defaults(void)
{
    CU_ASSERT_EQUAL(parse("follow.yaml"), MU_OK);
    CU_ASSERT_FALSE(quiet);
    CU_ASSERT_STRING_EQUAL(out, "out");
    CU_ASSERT_EQUAL(seed, 1);
    CU_ASSERT_EQUAL(set.count, 0);
    CU_ASSERT_EQUAL(options.words_count, 1);
    CU_ASSERT_STRING_EQUAL(options.words[0], "follow.yaml");
    CU_ASSERT_EQUAL(mu_options_find(&options, "seed")->source, MU_OPTION_DEFAULT);
}

static void test_flags_and_words_in_any_order(void)
{
    mu_result result = parse("a --seed 2 -qo x b --rate=-1.5 -s3 -4 --set a=1,2 --set b=2 - -- "
                             "--seed");
    CU_ASSERT_EQUAL(result, MU_OK);
    CU_ASSERT(quiet);
    CU_ASSERT_STRING_EQUAL(out, "x");
    CU_ASSERT_EQUAL(seed, 3);
    CU_ASSERT_DOUBLE_EQUAL(rate, -1.5, 0.0);
    CU_ASSERT_EQUAL(set.count, 2);
    CU_ASSERT_STRING_EQUAL(set.items[0], "a=1,2");
    CU_ASSERT_EQUAL(options.words_count, 5);
    CU_ASSERT_STRING_EQUAL(options.words[2], "-4");
    CU_ASSERT_STRING_EQUAL(options.words[4], "--seed");
    CU_ASSERT_EQUAL(mu_options_find(&options, "seed")->source, MU_OPTION_COMMAND_LINE);
    CU_ASSERT_STRING_EQUAL(broker, "no");
    CU_ASSERT_EQUAL(parse("--broker b a --broker"), MU_OK);
    CU_ASSERT_STRING_EQUAL(broker, "");
    CU_ASSERT_EQUAL(options.words_count, 1);
    CU_ASSERT_EQUAL(parse("--broker -q"), MU_OK);
    CU_ASSERT_STRING_EQUAL(broker, "");
    CU_ASSERT_EQUAL(parse("a --broker b"), MU_OK);
    CU_ASSERT_STRING_EQUAL(broker, "b");
    CU_ASSERT_EQUAL(parse("--robots a,b --robots=c --set a,b"), MU_OK);
    CU_ASSERT_EQUAL(set.count, 1);
    CU_ASSERT_EQUAL(robots.count, 3);
    CU_ASSERT_STRING_EQUAL(robots.items[1], "b");
    CU_ASSERT_STRING_EQUAL(robots.items[2], "c");
    CU_ASSERT_EQUAL(parse("--quiet --no-quiet"), MU_OK);
    CU_ASSERT_FALSE(quiet);
}

static void test_precedence(void)
{
    config_write("# shared by all programs\n"
                 "seed = 5   # a comment\n  out=a#b c\nset = p=1 , q\nquiet = yes\n"
                 "other-key = 1\n");
    CU_ASSERT_EQUAL(parse("a"), MU_OK);
    CU_ASSERT_EQUAL(seed, 5);
    CU_ASSERT_STRING_EQUAL(out, "a#b c");
    CU_ASSERT(quiet);
    CU_ASSERT_EQUAL(set.count, 2);
    CU_ASSERT_STRING_EQUAL(set.items[0], "p=1");
    CU_ASSERT_STRING_EQUAL(set.items[1], "q");
    CU_ASSERT_EQUAL(table[2].source, MU_OPTION_CONFIG);
    CU_ASSERT(strstr(table[2].place, "config:2") != NULL);

    setenv("MUSTER_SEED", "6", 1);
    setenv("MUSTER_SET", "r", 1);
    CU_ASSERT_EQUAL(parse("a"), MU_OK);
    CU_ASSERT_EQUAL(seed, 6);
    CU_ASSERT_EQUAL(set.count, 1);
    CU_ASSERT_EQUAL(table[2].source, MU_OPTION_ENVIRONMENT);
    CU_ASSERT_STRING_EQUAL(table[2].place, "MUSTER_SEED");

    CU_ASSERT_EQUAL(parse("--seed 7 --set s --no-quiet"), MU_OK);
    CU_ASSERT_EQUAL(seed, 7);
    CU_ASSERT_FALSE(quiet);
    CU_ASSERT_EQUAL(set.count, 1);
    CU_ASSERT_STRING_EQUAL(set.items[0], "s");
    unsetenv("MUSTER_SEED");
    unsetenv("MUSTER_SET");
    CU_ASSERT_EQUAL(remove(config), 0);
}

static void test_named_config_file(void)
{
    config_write("seed = 8\n");
    setenv("XDG_CONFIG_HOME", "/nonexistent", 1);
    CU_ASSERT_EQUAL(parse_with_config(), MU_OK);
    CU_ASSERT_EQUAL(seed, 8);
    CU_ASSERT_EQUAL(parse("--config /nonexistent/file"), MU_FAULT_FILE);
    CU_ASSERT(said("/nonexistent/file"));
    setenv("MUSTER_CONFIG", config, 1);
    CU_ASSERT_EQUAL(parse("a"), MU_OK);
    CU_ASSERT_EQUAL(seed, 8);
    unsetenv("MUSTER_CONFIG");
    CU_ASSERT_EQUAL(remove(config), 0);
}

static void test_bad_config_names_file_and_line(void)
{
    config_write("\nseed = many\n");
    CU_ASSERT_EQUAL(parse_with_config(), MU_FAULT_FILE);
    CU_ASSERT(said("/config:2: seed = many: expected a whole number"));
    config_write("seed\n");
    CU_ASSERT_EQUAL(parse_with_config(), MU_FAULT_FILE);
    CU_ASSERT(said("/config:1: expected 'name = value'"));
    CU_ASSERT_EQUAL(remove(config), 0);
}

static void test_wrong_usage(void)
{
    CU_ASSERT_EQUAL(parse("--sed 2"), MU_FAULT_USAGE);
    CU_ASSERT(said("unknown option '--sed'; did you mean '--seed'"));
    CU_ASSERT(said("try 'muster run --help'"));
    CU_ASSERT_EQUAL(parse("--completely-different=1"), MU_FAULT_USAGE);
    CU_ASSERT_EQUAL(parse("-x"), MU_FAULT_USAGE);
    CU_ASSERT_EQUAL(parse("--seed"), MU_FAULT_USAGE);
    CU_ASSERT(said("--seed needs a value: --seed N"));
    CU_ASSERT_EQUAL(parse("--seed 2.5"), MU_FAULT_USAGE);
    CU_ASSERT(said("--seed 2.5: expected a whole number"));
    CU_ASSERT_EQUAL(parse("--seed 99999999999999999999"), MU_FAULT_USAGE);
    CU_ASSERT_EQUAL(parse("--seed="), MU_FAULT_USAGE);
    CU_ASSERT_EQUAL(parse("--seed 1001"), MU_FAULT_USAGE);
    CU_ASSERT(said("expected 0 to 1000"));
    CU_ASSERT_EQUAL(parse("--rate nan"), MU_FAULT_USAGE);
    CU_ASSERT_EQUAL(parse("--rate 1e999"), MU_FAULT_USAGE);
    CU_ASSERT_EQUAL(parse("--quiet=perhaps"), MU_FAULT_USAGE);
    CU_ASSERT_EQUAL(parse("--no-seed"), MU_FAULT_USAGE);
    setenv("MUSTER_SEED", "x", 1);
    CU_ASSERT_EQUAL(parse("a"), MU_FAULT_USAGE);
    CU_ASSERT(said("environment variable MUSTER_SEED=x"));
    setenv("MUSTER_SEED", "", 1);
    CU_ASSERT_EQUAL(parse("a"), MU_OK);
    unsetenv("MUSTER_SEED");
}

static void test_a_program_without_words(void)
{
    options.no_words = true;
    CU_ASSERT_EQUAL(parse("--seed 2"), MU_OK);
    CU_ASSERT_EQUAL(parse("--seed 2 more"), MU_FAULT_USAGE);
    CU_ASSERT(said("muster run: expected options alone, not 'more'; try 'muster run --help'"));
    CU_ASSERT_EQUAL(parse("-- --seed"), MU_FAULT_USAGE);
    options.no_words = false;
}

static void test_help_and_version(void)
{
    CU_ASSERT_EQUAL(parse("--help"), MU_DONE);
    CU_ASSERT(said("usage: muster run FILE [OPTION...]"));
    CU_ASSERT(said("-s, --seed N"));
    CU_ASSERT(said("(default: 1) [MUSTER_SEED]"));
    CU_ASSERT(said("--config FILE"));
    CU_ASSERT_EQUAL(parse("-h"), MU_DONE);
    CU_ASSERT_EQUAL(parse("--version"), MU_DONE);
    CU_ASSERT(said("muster run " MU_VERSION));
}

static const char *repeat(const char *word, size_t count)
{
    static char line[16384];
    line[0] = '\0';
    for (size_t i = 0, len = 0; i < count; i++) {
        len += (size_t)snprintf(line + len, sizeof line - len, "%s%s", i ? " " : "", word);
    }
    return line;
}

static void test_limit_list_and_words(void)
{
    CU_ASSERT_EQUAL(parse(repeat("--set a=1", MU_OPTION_LIST_MAX)), MU_OK);
    CU_ASSERT_EQUAL(set.count, MU_OPTION_LIST_MAX);
    CU_ASSERT_EQUAL(parse(repeat("--set a=1", MU_OPTION_LIST_MAX + 1)), MU_FAULT_USAGE);
    CU_ASSERT(said("more than 1024"));
    CU_ASSERT_EQUAL(parse(repeat("w", MU_OPTION_WORDS_MAX)), MU_OK);
    CU_ASSERT_EQUAL(options.words_count, MU_OPTION_WORDS_MAX);
    CU_ASSERT_EQUAL(parse(repeat("w", MU_OPTION_WORDS_MAX + 1)), MU_FAULT_USAGE);
}

/* Each test finds its own, empty configuration folder and no MUSTER_* variable. */
static void set_up(void)
{
    char inner[48];
    snprintf(inner, sizeof inner, "%s/muster", folder);
    snprintf(config, sizeof config, "%s/config", inner);
    setenv("XDG_CONFIG_HOME", folder, 1);
}

static int folder_make(void)
{
    char inner[48];
    if (!mkdtemp(folder)) {
        return 1;
    }
    snprintf(inner, sizeof inner, "%s/muster", folder);
    static const char *const names[] = {"MUSTER_QUIET", "MUSTER_OUT", "MUSTER_SEED",
                                        "MUSTER_RATE",  "MUSTER_SET", "MUSTER_CONFIG"};
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
        unsetenv(names[i]);
    }
    return mkdir(inner, 0700);
}

static int folder_remove(void)
{
    char inner[48];
    snprintf(inner, sizeof inner, "%s/muster", folder);
    return rmdir(inner) || rmdir(folder);
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"defaults", test_defaults},
        {"flags and words in any order", test_flags_and_words_in_any_order},
        {"precedence", test_precedence},
        {"a named configuration file", test_named_config_file},
        {"a bad configuration names file and line", test_bad_config_names_file_and_line},
        {"wrong usage", test_wrong_usage},
        {"a program without words", test_a_program_without_words},
        {"help and version", test_help_and_version},
        {"limit: lists and words", test_limit_list_and_words},
        CU_TEST_INFO_NULL,
    };
    CU_SuiteInfo suites[] = {{"core/options", folder_make, folder_remove, set_up, NULL, tests},
                             CU_SUITE_INFO_NULL};
    return suites_run(suites);
}
