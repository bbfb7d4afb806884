/* SPDX-License-Identifier: Apache-2.0 */
/* --set KEY=VALUE. */
#include "experiment_text.h"

static void test_overrides(void)
{
    CU_ASSERT_EQUAL_FATAL(load(BASE "observer: [{at: 60, do: red, line: (a)}]\n", "duration=30"),
                          MU_OK);
    CU_ASSERT_DOUBLE_EQUAL(e->duration, 30, 0);
    CU_ASSERT_EQUAL_FATAL(load(BASE, "seed=7"), MU_OK);
    CU_ASSERT_EQUAL(e->seed, 7);
    CU_ASSERT_EQUAL_FATAL(load(BASE, "simulator.threads=2"), MU_OK);
    CU_ASSERT_EQUAL(e->simulator.threads, 2);
    CU_ASSERT_EQUAL_FATAL(load(BASE "simulator: {threads: 8}\n", "simulator.threads=3"), MU_OK);
    CU_ASSERT_EQUAL(e->simulator.threads, 3);
    CU_ASSERT_EQUAL_FATAL(load(BASE, "on-crash=stop"), MU_OK);
    CU_ASSERT_EQUAL(e->on_crash, EXPERIMENT_STOP);
    CU_ASSERT_EQUAL_FATAL(load(BASE, "robots.red.rules=b.clp"), MU_OK);
    CU_ASSERT(strstr(e->robots[0].rules, "/b.clp") != NULL);
    CU_ASSERT(strstr(e->robots[1].rules, "/a.clp") != NULL);
    CU_ASSERT_EQUAL_FATAL(load(BASE, "robots.blue.globals.mate=red"), MU_OK);
    CU_ASSERT_EQUAL_FATAL(e->robots[1].globals_count, 1);
    CU_ASSERT_STRING_EQUAL(e->robots[1].globals[0].value, "red");
    /* A broken value of the file does not matter once it is replaced. */
    CU_ASSERT_EQUAL(load(ROBOT("name: a.b") "seed: 3\n", "robots.a.b.color=x=y"), MU_OK);
    CU_ASSERT_STRING_EQUAL(e->robots[0].color, "x=y");
}

static void test_override_faults(void)
{
    static const struct {
        const char *set, *words;
    } cases[] = {
        {"duration", "expected KEY=VALUE with one of the keys name, world, seed"},
        {"speed=1", "expected KEY=VALUE"},
        {"robots.pink.rules=a.clp", "no robot 'pink' in this experiment"},
        {"robots.bleu.rules=a.clp", "; did you mean 'blue'?"},
        {"robots.red.name=a", "expected KEY=VALUE"},
        {"sede=3", "robots.NAME.globals.NAME; did you mean 'seed'?"},
        {"simulator.thread=3", "did you mean 'threads'?"},
        {"robots.red.rule=a.clp", "did you mean 'rules'?"},
        {"duration=soon", "expected a number"},
        {"duration=-1", "expected a duration of more than 0"},
        {"seed=1.5", "expected a whole number"},
        {"on-crash=", "expected stop or restart"},
        {"checkpoint=-1", "expected a time of 0"},
        {"robots.red.checkpoint=-1", "expected a time of 0"},
        {"restarts=x", "expected a whole number from 0"},
        {"simulator.threads=0", "expected 1 to 64 threads"},
        {"simulator.threads=-1", "expected a whole number"},
        {"world=", "expected a text"},
        {"world=no.world", "no.world': No such file"},
        {"policy=no.policy", "cannot read the policy '"},
        {"name=a b", "expected a name"},
        {"robots.red.rules=no.clp", "no.clp': No such file"},
        {"robots.red.globals.mate=(exit)", "expected one CLIPS field"},
        {"robots.red.globals.=x", "expected the name of a global"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        char place[80];
        snprintf(place, sizeof place, "--set %s", cases[i].set);
        CU_ASSERT_EQUAL(load(BASE, cases[i].set), MU_FAULT_USAGE);
        CU_ASSERT_STRING_EQUAL(fault.file, place);
        CU_ASSERT_EQUAL(fault.line, 0);
        if (!strstr(fault.text, cases[i].words)) {
            printf("\n%s: %s\n", place, fault.text);
            CU_FAIL("other words");
        }
    }
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"overrides", test_overrides},
        {"faults of overrides", test_override_faults},
        CU_TEST_INFO_NULL,
    };
    CU_SuiteInfo suites[] = {
        {"experiment/overrides", folder_make, folder_remove, NULL, NULL, tests},
        CU_SUITE_INFO_NULL};
    return suites_run(suites);
}
