/* SPDX-License-Identifier: Apache-2.0 */
#include "core/paths.h"
#include "suite.h"

#include <CUnit/Basic.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define PRINT "MUSTER_TEST_PRINT_RULES" /* in the environment of a copy of this program */

static char folder[] = "/tmp/muster-paths-XXXXXX";
static char library[64];

static void test_join(void)
{
    static const struct {
        const char *folder, *file, *want;
    } cases[] = {
        {"a", "b", "a/b"}, {"a/b", "../c", "a/b/../c"}, {"a", "/b", "/b"},         {"", "b", "b"},
        {"", "/b", "/b"},  {"/", "b", "//b"},           {"a b", "c d", "a b/c d"}, {"a", "", "a/"},
        {"", "", ""},
    };
    char path[32];
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        CU_ASSERT_TRUE(mu_path_join(path, sizeof path, cases[i].folder, cases[i].file));
        CU_ASSERT_STRING_EQUAL(path, cases[i].want);
    }
}

static void test_plain_paths_have_no_steps_up(void)
{
    static const struct {
        const char *path, *want;
    } cases[] = {
        {"/a/b", "/a/b"},
        {"/a/../b", "/b"},
        {"/a/b/../../c/./d", "/c/d"},
        {"/a/..", "/"},
        {"/../../a", "/a"},
        {"/a//b/", "/a/b"},
        {"/a/.b/..c/...", "/a/.b/..c/..."},
        {"/", "/"},
        {"a/../b", "a/../b"},
        {"", ""},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        char path[32];
        snprintf(path, sizeof path, "%s", cases[i].path);
        mu_path_plain(path);
        READS(path, cases[i].want);
    }
}

static void test_limit_join(void)
{
    char path[8];
    CU_ASSERT_TRUE(mu_path_join(path, sizeof path, "abc", "def"));
    CU_ASSERT_STRING_EQUAL(path, "abc/def");
    CU_ASSERT_FALSE(mu_path_join(path, sizeof path, "abc", "defg"));
    CU_ASSERT_FALSE(mu_path_join(path, sizeof path, "abcdefghi", "d"));
    CU_ASSERT_FALSE(mu_path_join(path, sizeof path, "a", "/bcdefgh"));
    CU_ASSERT_EQUAL(strlen(path), 7);
}

static void test_programs_stand_beside_the_running_one(void)
{
    char self[PATH_MAX];
    char path[PATH_MAX];
    ssize_t len = readlink("/proc/self/exe", self, sizeof self - 1);
    CU_ASSERT_FATAL(len > 0);
    self[len] = '\0';
    CU_ASSERT_TRUE(mu_path_program(path, sizeof path, strrchr(self, '/') + 1));
    CU_ASSERT_STRING_EQUAL(path, self);
    CU_ASSERT_TRUE(mu_path_program(path, sizeof path, "/bin/sh"));
    CU_ASSERT_STRING_EQUAL(path, "/bin/sh");
    CU_ASSERT_FALSE(mu_path_program(path, 4, "muster"));
}

static void library_make(void)
{
    FILE *file = fopen(library, "w");
    CU_ASSERT_PTR_NOT_NULL_FATAL(file);
    fclose(file);
}

static void test_chosen_rules_must_have_the_library(void)
{
    char path[PATH_MAX];
    setenv("MUSTER_RULES", folder, 1);
    CU_ASSERT_FALSE(mu_path_rules(path, sizeof path));
    library_make();
    CU_ASSERT_TRUE(mu_path_rules(path, sizeof path));
    CU_ASSERT_STRING_EQUAL(path, folder);
    CU_ASSERT_FALSE(mu_path_rules(path, 6));
    setenv("MUSTER_RULES", "/nowhere/at/all", 1);
    CU_ASSERT_FALSE(mu_path_rules(path, sizeof path));
    CU_ASSERT_EQUAL(remove(library), 0);
}

/* A test stands in build/VARIANT/test, as a program stands in build/VARIANT/bin. */
static void test_rules_of_the_source_tree(void)
{
    static const char *const choices[] = {NULL, ""};
    for (size_t i = 0; i < 2; i++) {
        char path[PATH_MAX];
        char file[PATH_MAX];
        unsetenv("MUSTER_RULES");
        if (choices[i]) {
            setenv("MUSTER_RULES", choices[i], 1);
        }
        CU_ASSERT_TRUE_FATAL(mu_path_rules(path, sizeof path));
        CU_ASSERT_TRUE(mu_path_join(file, sizeof file, path, "muster.clp"));
        CU_ASSERT_EQUAL(access(file, R_OK), 0);
    }
}

/* Runs a copy of this program and takes what it finds, without the folder of the test. */
static const char *rules_of_copy(void)
{
    static char found[PATH_MAX];
    char command[128];
    snprintf(command, sizeof command, PRINT "=1 %s/usr/local/bin/copy paths", folder);
    FILE *answer = popen(command, "r");
    CU_ASSERT_PTR_NOT_NULL_FATAL(answer);
    char *line = fgets(found, sizeof found, answer);
    pclose(answer);
    found[line ? strcspn(found, "\n") : 0] = '\0';
    return strncmp(found, folder, strlen(folder)) == 0 ? found + strlen(folder) : found;
}

static void shell(const char *words)
{
    char command[512];
    snprintf(command, sizeof command, "cd %s && %s", folder, words);
    CU_ASSERT_EQUAL_FATAL(system(command), 0);
}

static void test_an_installed_program_takes_no_strangers_rules(void)
{
    char self[PATH_MAX];
    char copy[PATH_MAX + 64];
    ssize_t len = readlink("/proc/self/exe", self, sizeof self - 1);
    CU_ASSERT_FATAL(len > 0 && len < 400);
    self[len] = '\0';
    unsetenv("MUSTER_RULES");
    snprintf(copy, sizeof copy, "mkdir -p usr/local/bin rules && cp %.400s usr/local/bin/copy",
             self);
    shell(copy);
    shell("touch rules/muster.clp");
    CU_ASSERT_STRING_EQUAL(rules_of_copy(), "none");
    shell("mkdir idl && touch idl/wire.idl");
    CU_ASSERT_STRING_EQUAL(rules_of_copy(), "/usr/local/bin/../../../rules");
    shell("mkdir -p usr/local/share/muster/rules && touch usr/local/share/muster/rules/muster.clp");
    CU_ASSERT_STRING_EQUAL(rules_of_copy(), "/usr/local/bin/../share/muster/rules");
    shell("rm -r usr rules idl");
}

static int rules_print(void)
{
    char path[PATH_MAX];
    puts(mu_path_rules(path, sizeof path) ? path : "none");
    return EXIT_SUCCESS;
}

static int folder_make(void)
{
    if (!mkdtemp(folder)) {
        return 1;
    }
    snprintf(library, sizeof library, "%s/muster.clp", folder);
    return 0;
}

static int folder_remove(void)
{
    return rmdir(folder);
}

int main(void)
{
    if (getenv(PRINT)) {
        return rules_print();
    }
    CU_TestInfo tests[] = {
        {"join", test_join},
        {"plain paths have no steps up", test_plain_paths_have_no_steps_up},
        {"limit: what does not fit", test_limit_join},
        {"programs beside the running one", test_programs_stand_beside_the_running_one},
        {"chosen rules must have the library", test_chosen_rules_must_have_the_library},
        {"rules of the source tree", test_rules_of_the_source_tree},
        {"an installed program takes no stranger's rules",
         test_an_installed_program_takes_no_strangers_rules},
        CU_TEST_INFO_NULL,
    };
    CU_SuiteInfo suites[] = {{"core/paths", folder_make, folder_remove, NULL, NULL, tests},
                             CU_SUITE_INFO_NULL};
    return suites_run(suites);
}
