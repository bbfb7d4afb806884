/* SPDX-License-Identifier: Apache-2.0 */
#include "experiment_text.h"

static void test_defaults(void)
{
    char want[80];
    CU_ASSERT_EQUAL_FATAL(load(BASE, NULL), MU_OK);
    CU_ASSERT_STRING_EQUAL(e->name, "test-1");
    CU_ASSERT_EQUAL(e->seed, 1);
    CU_ASSERT_DOUBLE_EQUAL(e->duration, 120, 0);
    CU_ASSERT_DOUBLE_EQUAL(e->step_ms, 100, 0);
    CU_ASSERT_EQUAL(e->on_crash, EXPERIMENT_STOP);
    CU_ASSERT_DOUBLE_EQUAL(e->checkpoint_s, 1, 0);
    CU_ASSERT_EQUAL(e->restarts, 5);
    CU_ASSERT_DOUBLE_EQUAL(e->return_within_s, 20, 0);
    CU_ASSERT_EQUAL(e->simulator.threads, 0);
    CU_ASSERT_EQUAL(e->observer_count, 0);
    CU_ASSERT_STRING_EQUAL(e->folder, folder);
    snprintf(want, sizeof want, "%s/a.world", folder);
    CU_ASSERT_STRING_EQUAL(e->world, want);
    CU_ASSERT_EQUAL_FATAL(e->robots_count, 2);
    CU_ASSERT_STRING_EQUAL(e->robots[0].name, "red");
    CU_ASSERT_PTR_NULL(e->robots[0].body);
    CU_ASSERT_PTR_NULL(e->robots[0].pose);
    CU_ASSERT_PTR_NOT_NULL_FATAL(e->robots[1].pose);
    CU_ASSERT_DOUBLE_EQUAL(e->robots[1].pose->y_m, -2.5, 0);
    CU_ASSERT_DOUBLE_EQUAL(e->robots[1].pose->heading_deg, 90, 0);
    CU_ASSERT_STRING_EQUAL(e->robots[1].color, "#00f");
}

static void test_what_is_started_again(void)
{
    CU_ASSERT_EQUAL_FATAL(
        load("world: a.world\nduration: 1\non-crash: restart\ncheckpoint: 0.5\nrestarts: 3\n"
             "return-within: 7.5\n"
             "robots:\n  - {name: red, rules: a.clp}\n"
             "  - {name: blue, rules: a.clp, on-crash: stop, checkpoint: 0}\n"
             "  - {name: w, rules: a.clp, count: 2, checkpoint: 2}\n",
             NULL),
        MU_OK);
    CU_ASSERT_EQUAL(e->on_crash, EXPERIMENT_RESTART);
    CU_ASSERT_EQUAL(e->restarts, 3);
    CU_ASSERT_DOUBLE_EQUAL(e->return_within_s, 7.5, 0);
    CU_ASSERT_EQUAL(e->robots[0].on_crash, EXPERIMENT_RESTART);
    CU_ASSERT_DOUBLE_EQUAL(e->robots[0].checkpoint_s, 0.5, 0);
    CU_ASSERT_EQUAL(e->robots[1].on_crash, EXPERIMENT_STOP);
    CU_ASSERT_DOUBLE_EQUAL(e->robots[1].checkpoint_s, 0, 0);
    CU_ASSERT_EQUAL(e->robots[3].on_crash, EXPERIMENT_RESTART);
    CU_ASSERT_DOUBLE_EQUAL(e->robots[3].checkpoint_s, 2, 0);
    CU_ASSERT_EQUAL_FATAL(load(BASE, "robots.red.on-crash=restart"), MU_OK);
    CU_ASSERT_EQUAL(e->robots[0].on_crash, EXPERIMENT_RESTART);
    CU_ASSERT_EQUAL(e->robots[1].on_crash, EXPERIMENT_STOP);
    CU_ASSERT_EQUAL_FATAL(load(BASE, "on-crash=restart"), MU_OK);
    CU_ASSERT_EQUAL(e->robots[1].on_crash, EXPERIMENT_RESTART);
    CU_ASSERT_EQUAL_FATAL(load(BASE "free: Yes\nbroker: {store: off}\n", "restarts=9"), MU_OK);
    CU_ASSERT_EQUAL(e->restarts, 9);
    CU_ASSERT(e->free && !e->broker.store);
}

static void test_everything(void)
{
    CU_ASSERT_EQUAL_FATAL(
        load("name: all-of-it\nseed: 18446744073709551615\nstep_ms: 60\non-crash: stop\n"
             "brokers: [b1]\nbroker: {delivery-interval: 20}\nresolvers: [near, role]\n"
             "simulator: {threads: 4}\nworld: a.world\nduration: 60.5\n"
             "robots:\n  - name: red\n    rules: a.clp\n    globals: {mate: blue, n: '\"a b\"'}\n"
             "  - {name: blue, rules: a.clp, groups: [g, scouts], services: [map x=1 y=2, sing]}\n"
             "observer:\n  - {at: 0, do: all, line: '(run)'}\n"
             "  - {at: 2.5, do: [red, 'role:scout', 'group:g'], line: (stop)}\n"
             "expect:\n  - {near: [blue, red], within: 2.5}\n"
             "  - {near: [red, blue], within: 1, from: 3, to: 4, share: 0.8}\n"
             "  - {inside: arena}\n  - {stall-max: 10}\n",
             NULL),
        MU_OK);
    CU_ASSERT_STRING_EQUAL(e->name, "all-of-it");
    CU_ASSERT_EQUAL(e->seed, UINT64_MAX);
    CU_ASSERT_EQUAL(e->on_crash, EXPERIMENT_STOP);
    CU_ASSERT_DOUBLE_EQUAL(e->broker.delivery_interval_ms, 20, 0);
    CU_ASSERT_EQUAL(e->simulator.threads, 4);
    CU_ASSERT_EQUAL_FATAL(e->brokers_count, 1);
    CU_ASSERT_STRING_EQUAL(e->brokers[0], "b1");
    CU_ASSERT_EQUAL_FATAL(e->resolvers_count, 2);
    CU_ASSERT_STRING_EQUAL(e->resolvers[1], "role");
    CU_ASSERT_EQUAL_FATAL(e->robots[0].globals_count, 2);
    CU_ASSERT_STRING_EQUAL(e->robots[0].globals[0].name, "mate");
    CU_ASSERT_STRING_EQUAL(e->robots[0].globals[1].value, "\"a b\"");
    CU_ASSERT_EQUAL(e->robots[0].groups_count, 0);
    CU_ASSERT_EQUAL_FATAL(e->robots[1].groups_count, 2);
    CU_ASSERT_STRING_EQUAL(e->robots[1].groups[1], "scouts");
    CU_ASSERT_EQUAL_FATAL(e->robots[1].services_count, 2);
    CU_ASSERT_STRING_EQUAL(e->robots[1].services[0], "map x=1 y=2");
    CU_ASSERT_EQUAL_FATAL(e->observer_count, 2);
    CU_ASSERT_EQUAL_FATAL(e->observer[0].targets_count, 1);
    CU_ASSERT_STRING_EQUAL(e->observer[0].targets[0], "all");
    CU_ASSERT_EQUAL_FATAL(e->observer[1].targets_count, 3);
    CU_ASSERT_STRING_EQUAL(e->observer[1].targets[1], "role:scout");
    CU_ASSERT_STRING_EQUAL(e->observer[1].line, "(stop)");
    CU_ASSERT_EQUAL_FATAL(e->expect_count, 4);
    CU_ASSERT_STRING_EQUAL(e->expect[0].near_robot, "blue");
    CU_ASSERT_STRING_EQUAL(e->expect[0].near_mate, "red");
    CU_ASSERT_DOUBLE_EQUAL(e->expect[0].share, 1, 0);
    CU_ASSERT(e->expect[0].to_s > 60.5);
    CU_ASSERT_DOUBLE_EQUAL(e->expect[1].to_s, 4, 0);
    CU_ASSERT_STRING_EQUAL(e->expect[2].inside, "arena");
    CU_ASSERT_DOUBLE_EQUAL(e->expect[3].stall_max_s, 10, 0);
}

struct bad_case {
    const char *text;
    int line, column;
    const char *words; /* that the fault must hold */
};

static void check_bad(const struct bad_case *cases, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        mu_result result = load(cases[i].text, NULL);
        bool good = result == MU_FAULT_FILE && fault.line == cases[i].line &&
                    fault.column == cases[i].column && strstr(fault.text, cases[i].words) &&
                    strcmp(fault.file, path) == 0 && !e;
        if (!good) {
            printf("\ncase %zu: %s: got ", i, cases[i].words);
            fflush(stdout);
            mu_fault_print(&fault);
        }
        CU_ASSERT(good);
    }
}
#define CHECK_BAD(cases) check_bad(cases, sizeof(cases) / sizeof(cases)[0])

static void test_schema_faults(void)
{
    static const struct bad_case cases[] = {
        {"", 0, 0, "expected a mapping with the keys name, world, seed, duration"},
        {"- a\n", 1, 1, "expected a mapping"},
        {"world: [\n", 2, 1, "not YAML"},
        {"world: a\n\tb: c\n", 2, 1, "not YAML"},
        {BASE "--- \na: b\n", 7, 1, "second YAML document"},
        {"a: 1\nworld: \xff\n", 2, 8, "expected UTF-8"},
        {BASE "sed: 2\n", 6, 1, "unknown key 'sed'; expected one of: name, world, seed"},
        {BASE "sed: 2\n", 6, 1, "chaos, free; did you mean 'seed'?"},
        {BASE "expect: [{nearr: [red, blue]}]\n", 6, 11, "never; did you mean 'near'?"},
        {BASE "zzzzzz: 2\n", 6, 1, "chaos, free"},
        {BASE "broker: {store: banana}\n", 6, 17, "expected true or false, not 'banana'"},
        {BASE "restarts: 4294967296\n", 6, 11, "expected a whole number from 0"},
        {BASE "seed: 2\nseed: 3\n", 7, 1, "'seed' stands here a second time"},
        {BASE "seed: -1\n", 6, 7, "expected a whole number from 0, not '-1'"},
        {BASE "seed: 010\n", 6, 7, "expected a whole number from 0"},
        {BASE "seed: 18446744073709551616\n", 6, 7, "expected a whole number"},
        {BASE "on-crash: explode\n", 6, 11, "expected stop or restart, not 'explode'"},
        {BASE "checkpoint: -1\n", 6, 13, "expected a time of 0 to 1000000 s, not -1"},
        {BASE "restarts: 1001\n", 6, 11, "expected 0 to 1000 restarts, not 1001"},
        {BASE "return-within: 0\n", 6, 16, "expected a time of more than 0"},
        {BASE "on-crash: 1\n", 6, 11, "expected stop"},
        {BASE "name:\n", 6, 6, "expected a text, not 'nothing'"},
        {BASE "name: [a]\n", 6, 7, "expected a text, not 'a list'"},
        {BASE "brokers: b\n", 6, 10, "expected a list, not 'b'"},
        {"duration: 1\nrobots: [{name: a, rules: a.clp}]\n", 1, 1, "expected a key 'world'"},
        {"world: a.world\nduration: 1\n", 1, 1, "expected robots, or agents"},
        {"world: a.world\nduration: abc\nrobots: []\n", 2, 11, "expected a number, not 'abc'"},
        {"world: a.world\nduration: .inf\nrobots: []\n", 2, 11, "expected a number"},
        {"world: a.world\nduration: nan\nrobots: []\n", 2, 11, "expected a number"},
        {"world: a.world\nduration: 1e999\nrobots: []\n", 2, 11, "expected a number"},
        {"world: a.world\nduration: 1\nrobots: []\n", 3, 9, "expected at least 1 in this list"},
        {"world: a.world\nduration: 1\nrobots: {}\n", 3, 9, "expected a list"},
        {"world: a.world\nduration: 1\nrobots: &a [*a]\n", 3, 9, "expected a mapping"},
        {"world: a.world\nduration: 1\nrobots: [{name: a}]\n", 3, 10,
         "expected either rules: FILE, or controller: {program: FILE}"},
        {"world: a.world\nduration: 1\nrobots: [{name: a, rules: a.clp, pose: [1, 2]}]\n", 3, 40,
         "expected 3 in this list, not 2"},
        {"world: a.world\nduration: 1\nrobots: [{name: a, rules: a.clp, pose: [1, x, 2]}]\n", 3, 44,
         "expected a number, not 'x'"},
    };
    CHECK_BAD(cases);
}

static void test_agent_faults(void)
{
    static const struct bad_case cases[] = {
        {BASE "agents: [{name: red, rules: a.clp}]\n", 6, 17, "a second robot or agent"},
        {BASE "agents: [{name: boss, rules: a.clp, body: b}]\n", 6, 37, "unknown key 'body'"},
        {BASE "agents: [{name: boss}]\n", 6, 10,
         "expected either rules: FILE, or controller: {program: FILE}"},
        {BASE "simulator: none\n", 1, 8, "expected no world: there is no simulator"},
        {BASE "simulator: nobody\n", 6, 12, "expected a mapping"},
        {"simulator: none\nduration: 1\nrobots: [{name: a, rules: a.clp}]\n", 3, 9,
         "expected agents alone"},
        {BASE "agents: [{name: boss, rules: a.clp}]\nexpect: [{near: [red, boss], within: 1}]\n", 7,
         23, "no robot 'boss' in this experiment"},
    };
    CHECK_BAD(cases);
}

static void test_agents(void)
{
    static const char text[] = "simulator: none\nduration: 1\nagents:\n"
                               "  - {name: boss, rules: a.clp, standby: true}\n"
                               "  - {name: w, count: 5, processes: 2, rules: a.clp}\n"
                               "observer: [{at: 0, do: w_4, line: \"(x)\"}]\n"
                               "expect: [{statistic: w_1.mail_sent, at_least: 0}]\n";
    CU_ASSERT_EQUAL_FATAL(load(text, NULL), MU_OK);
    CU_ASSERT_TRUE(e->simulator.none);
    CU_ASSERT_EQUAL(e->robots_count, 0);
    CU_ASSERT_EQUAL_FATAL(e->agents_count, 6);
    CU_ASSERT_EQUAL_FATAL(e->crews_count, 3);
    CU_ASSERT_TRUE(e->agents[0].standby);
    CU_ASSERT_STRING_EQUAL(e->agents[5].name, "w_4");
    CU_ASSERT_EQUAL(e->crews[2].count, 3);
    CU_ASSERT_EQUAL(experiment_robot_find(e, "w_2"), 3);
}

static void test_robot_faults(void)
{
    static const struct bad_case cases[] = {
        {ROBOT("name: 9lives"), 4, 26, "not '9lives'"},
        {ROBOT("name: a2345678901234567890123456789012"), 4, 26, "expected a name of 1 to 31"},
        {ROBOT("name: all"), 4, 26, "the name 'all' is reserved"},
        {ROBOT("name: broker.x"), 4, 26, "reserved"},
        {BASE "  - {name: red, rules: a.clp}\n", 6, 12, "a second robot with the name 'red'"},
        {BASE "  - {name: red2, rules: none.clp}\n", 6, 25, "none.clp': No such file"},
        {ROBOT("name: a, body: b"), 4, 35, "expected a pose"},
        {ROBOT("name: a, globals: [b]"), 4, 38, "expected a mapping of globals"},
        {ROBOT("name: a, globals: {b: [c]}"), 4, 42, "expected one CLIPS field"},
        {ROBOT("name: a, globals: {b: c) (d}"), 4, 42, "expected one CLIPS field"},
        {ROBOT("name: a, globals: {b: '\"c\" (d \"e\"'}"), 4, 42, "expected one CLIPS field"},
        {ROBOT("name: a, globals: {b: '\"c\\\"'}"), 4, 42, "expected one CLIPS field"},
        {ROBOT("name: a, globals: {'?*b*': c}"), 4, 39, "without ?* and *"},
        {ROBOT("name: a, globals: {b: c, b: d}"), 4, 45, "'b' stands here a second time"},
        {ROBOT("name: a, groups: [g, 1st]"), 4, 41, "name of a group, not '1st'"},
        {ROBOT("name: a, groups: g"), 4, 37, "expected"},
        {ROBOT("name: a, services: [1st]"), 4, 40, "such as 'mapper role=scout', not '1st'"},
        {ROBOT("name: a, services: ['map x']"), 4, 40, "not 'map x'"},
        {ROBOT("name: a, services: [map, '']"), 4, 45, "expected a text"},
    };
    CHECK_BAD(cases);
}

static void test_many_robots(void)
{
    CU_ASSERT_EQUAL_FATAL(
        load(BASE "  - {name: w, count: 5, processes: 2, rules: b.clp, body: p, place: random}\n"
                  "observer: [{at: 1, do: [w_0, w_4], line: (a)}]\n",
             "robots.w.color=red"),
        MU_OK);
    CU_ASSERT_EQUAL_FATAL(e->robots_count, 7);
    CU_ASSERT_STRING_EQUAL(e->robots[1].name, "blue");
    for (unsigned i = 0; i < 5; i++) {
        char name[8];
        snprintf(name, sizeof name, "w_%u", i);
        CU_ASSERT_STRING_EQUAL(e->robots[2 + i].name, name);
        CU_ASSERT_STRING_EQUAL(e->robots[2 + i].place, "random");
        CU_ASSERT_STRING_EQUAL(e->robots[2 + i].color, "red");
        CU_ASSERT_PTR_NULL(e->robots[2 + i].pose);
    }
    static const struct experiment_crew want[] = {{"red", 0, 1, 0, false},
                                                  {"blue", 1, 1, 0, false},
                                                  {"w", 2, 2, 0, true},
                                                  {"w", 4, 3, 2, true}};
    CU_ASSERT_EQUAL_FATAL(e->crews_count, 4);
    for (unsigned i = 0; i < 4; i++) {
        CU_ASSERT_STRING_EQUAL(e->crews[i].name, want[i].name);
        CU_ASSERT_EQUAL(e->crews[i].robot, want[i].robot);
        CU_ASSERT_EQUAL(e->crews[i].count, want[i].count);
        CU_ASSERT_EQUAL(e->crews[i].first, want[i].first);
        CU_ASSERT_EQUAL(e->crews[i].numbered, want[i].numbered);
    }
    /* One of many is still many: it bears a number. */
    CU_ASSERT_EQUAL_FATAL(load(ROBOT("name: w, count: 1"), NULL), MU_OK);
    CU_ASSERT_STRING_EQUAL(e->robots[0].name, "w_0");
}

static void test_faults_of_many_robots(void)
{
    static const struct bad_case cases[] = {
        {ROBOT("name: w, count: 0"), 4, 36, "expected a count of 1 to 1024, not 0"},
        {ROBOT("name: w, count: 1025"), 4, 36, "expected a count of 1 to 1024, not 1025"},
        {ROBOT("name: w, count: -1"), 4, 36, "expected"},
        {ROBOT("name: w, processes: 2"), 4, 40, "beside 'count' only"},
        {ROBOT("name: w, count: 2, processes: 3"), 4, 50, "no more than robots, not 3"},
        {ROBOT("name: w, count: 2, processes: 0"), 4, 50, "expected 1 to 64 processes"},
        {ROBOT("name: w, count: 99, processes: 65"), 4, 51, "expected 1 to 64 processes"},
        {ROBOT("name: a2345678901234567890123456789, count: 11"), 4, 26,
         "a shorter name: with _10"},
        {ROBOT("name: w, count: 2, pose: [1, 2, 3]"), 4, 45, "place: random for many"},
        {ROBOT("name: w, place: here"), 4, 36, "expected random, not 'here'"},
        {ROBOT("name: w, place: random, pose: [1, 2, 3]"), 4, 36, "not both"},
        {ROBOT("name: w, count: 2, body: b"), 4, 45, "or place: random"},
        {BASE "  - {name: w, count: 2, rules: a.clp}\n  - {name: w_1, rules: a.clp}\n", 7, 5,
         "a second robot with the name 'w_1'"},
        {BASE "  - {name: w, count: 1023, rules: a.clp}\n", 6, 5, "at most 1024 robots"},
        {BASE "  - {name: w, count: 2, rules: a.clp}\n"
              "observer: [{at: 1, do: w_2, line: (a)}]\n",
         7, 24, "no robot 'w_2'"},
    };
    CHECK_BAD(cases);
}

static void test_other_faults(void)
{
    static const struct bad_case cases[] = {
        {"world: no.world\nduration: 1\nrobots: [{name: a, rules: a.clp}]\n", 1, 8,
         "no.world': No such file"},
        {"world: a.world\nduration: 0\nrobots: [{name: a, rules: a.clp}]\n", 2, 11,
         "expected a duration of more than 0"},
        {"world: a.world\nduration: 1e7\nrobots: [{name: a, rules: a.clp}]\n", 2, 11,
         "at most 1000000 s"},
        {BASE "step_ms: 0\n", 6, 10, "expected a control step"},
        {BASE "step_ms: 50\n", 6, 10, "expected a multiple of 20 ms"},
        {BASE "step_ms: 10001\n", 6, 10, "expected a control step"},
        {BASE "name: a/b\n", 6, 7, "expected a name"},
        {BASE "name: ..\n", 6, 7, "expected a name"},
        {BASE "brokers: [b c]\n", 6, 11, "cannot be a broker's name"},
        {BASE "brokers: [robots]\n", 6, 11, "cannot be a broker's name"},
        {BASE "resolvers: [near:2]\n", 6, 13, "expected a scheme of addresses"},
        {BASE "resolvers: [role, foo]\n", 6, 19, "role, task or near, not 'foo'"},
        {BASE "resolvers: [near, role, near]\n", 6, 25, "stands here a second time"},
        {BASE "broker: {delivery-interval: -1}\n", 6, 29, "0 to 60000 ms, not -1"},
        {BASE "broker: {delivery-interval: 60001}\n", 6, 29, "0 to 60000 ms"},
        {BASE "broker: {delivery-interval: .nan}\n", 6, 29, "expected"},
        {BASE "broker: {delivery: 1}\n", 6, 10, "expected"},
        {BASE "broker: main\n", 6, 9, "expected a mapping"},
        {BASE "simulator: {threads: 0}\n", 6, 22, "expected 1 to 64 threads, not 0"},
        {BASE "simulator: {threads: 65}\n", 6, 22, "expected 1 to 64 threads, not 65"},
        {BASE "simulator: {threads: two}\n", 6, 22, "expected"},
        {BASE "simulator: {thread: 2}\n", 6, 13, "expected"},
        {BASE "brokers: [a, b, c, d, e]\n", 6, 10, "expected at most 4"},
        {BASE "brokers: [b, c, b]\n", 6, 17, "a second broker with the name 'b'"},
        {"world: a.world\nduration: 1\nbrokers: [b]\n"
         "robots: [{name: a, rules: a.clp, broker: c}]\n",
         4, 42, "no broker 'c'"},
        {BASE "observer:\n  - {at: 1, do: pink, line: (a)}\n", 7, 17, "no robot 'pink'"},
        {BASE "observer:\n  - {at: 1, do: [red, pink], line: (a)}\n", 7, 23, "no robot 'pink'"},
        {BASE "observer:\n  - {at: 1, do: 'role:', line: (a)}\n", 7, 17, "SCHEME:REST"},
        {BASE "observer:\n  - {at: 1, do: [], line: (a)}\n", 7, 17, "expected at least 1"},
        {BASE "observer:\n  - {at: 1, do: [[red]], line: (a)}\n", 7, 18, "expected a robot's"},
        {BASE "observer:\n  - {at: -1, do: red, line: (a)}\n", 7, 10, "expected a time from 0"},
        {BASE "observer:\n  - {at: 121, do: red, line: (a)}\n", 7, 10, "at most the duration"},
        {BASE "observer:\n  - {at: 1, line: (a)}\n", 7, 5, "expected a key 'do'"},
        {BASE "expect:\n  - {within: 1}\n", 7, 5, "expected one of near, inside, stall-max"},
        {BASE "expect:\n  - {inside: arena, stall-max: 1}\n", 7, 5, "expected one of near"},
        {BASE "expect:\n  - {inside: here}\n", 7, 14, "expected arena, not 'here'"},
        {BASE "expect:\n  - {inside: arena, share: 1}\n", 7, 28, "'share' beside 'near' only"},
        {BASE "expect:\n  - {inside: arena, at: [1, 2]}\n", 7, 25, "'at' beside 'objects' only"},
        {BASE "expect:\n  - {objects: a, within: 1}\n", 7, 5, "expected at: [X, Y]"},
        {BASE "expect:\n  - {objects: a, at: [1, 2]}\n", 7, 5, "expected within"},
        {BASE "expect:\n  - {objects: a, at: [1, 2], within: 0}\n", 7, 38, "more than 0 m"},
        {BASE "expect:\n  - {objects: a, at: [1, 2], within: 1, count: 0}\n", 7, 48, "1 or more"},
        {BASE "expect:\n  - {objects: a, at: [1, 2], within: 1, from: -1}\n", 7, 47, "from 0"},
        {BASE "expect:\n  - {objects: a, at: [1, 2], within: 1, from: 1e9}\n", 7, 47,
         "before the end"},
        {BASE "expect:\n  - {objects: a, at: [1], within: 1}\n", 7, 22, "expected 2 in this list"},
        {BASE "expect:\n  - {objects: a, at: [1, 2], within: 1, share: 1}\n", 7, 48,
         "'share' beside 'near' only"},
        {BASE "expect:\n  - {stall-max: -1}\n", 7, 17, "more than 0 s"},
        {BASE "expect:\n  - {near: [red], within: 1}\n", 7, 12, "expected two robots"},
        {BASE "expect:\n  - {near: [red, pink], within: 1}\n", 7, 18, "no robot 'pink'"},
        {BASE "expect:\n  - {near: [red, red], within: 1}\n", 7, 12, "two different robots"},
        {BASE "expect:\n  - {near: [red, blue]}\n", 7, 5, "expected within"},
        {BASE "expect:\n  - {near: [red, blue], within: 1, from: 9, to: 9}\n", 7, 42, "a later"},
        {BASE "expect:\n  - {near: [red, blue], within: 1, from: 120}\n", 7, 42, "before the end"},
        {BASE "expect:\n  - {near: [red, blue], within: 1, share: 80}\n", 7, 43, "a share"},
    };
    CHECK_BAD(cases);
}

#define HOSTS        "world: a.world\nduration: 9\nhosts: [north, south]\n"
#define LAUNCH(deed) HOSTS "robots: [{name: a, rules: a.clp}]\nobserver: [{at: 1, " deed "}]\n"

static void test_hosts(void)
{
    CU_ASSERT_EQUAL_FATAL(load(HOSTS "robots: [{name: a, rules: a.clp, host: south}]\n"
                                     "observer: [{at: 2, do: a, move: north}]\n",
                               NULL),
                          MU_OK);
    CU_ASSERT_EQUAL_FATAL(e->hosts_count, 2);
    CU_ASSERT_STRING_EQUAL(e->hosts[1], "south");
    CU_ASSERT_STRING_EQUAL(e->robots[0].host, "south");
    CU_ASSERT_STRING_EQUAL(e->observer[0].move, "north");
    CU_ASSERT_PTR_NULL(e->observer[0].line);
    CU_ASSERT_EQUAL_FATAL(load(LAUNCH("do: north, launch: b, rules: a.clp"), NULL), MU_OK);
    static const struct bad_case cases[] = {
        {BASE "hosts: [b c]\n", 6, 9, "cannot be a host's name"},
        {BASE "hosts: [n, m, n]\n", 6, 15, "a second host, or a robot, has the name 'n'"},
        {BASE "hosts: [n, red]\n", 6, 12, "or a robot, has the name 'red'"},
        {HOSTS "robots: [{name: a, rules: a.clp, host: east}]\n", 4, 40, "no host 'east'"},
        {HOSTS "brokers: [b]\nrobots: [{name: a, rules: a.clp, host: north, broker: b}]\n", 5, 40,
         "not both"},
        {HOSTS "robots: [{name: a, rules: a.clp, host: north, count: 2, processes: 2}]\n", 4, 40,
         "not both"},
        {HOSTS "robots: [{name: a, rules: a.clp}]\nobserver: [{at: 1, do: a}]\n", 5, 12,
         "expected a line, or move"},
        {HOSTS "robots: [{name: a, rules: a.clp}]\n"
               "observer: [{at: 1, do: a, line: (a), move: north}]\n",
         5, 12, "expected a line, or move"},
        {HOSTS "robots: [{name: a, rules: a.clp}]\nobserver: [{at: 1, do: a, move: east}]\n", 5, 33,
         "no host 'east'"},
        {LAUNCH("do: east, launch: b, rules: a.clp"), 5, 24, "no host 'east'"},
        {LAUNCH("do: north, launch: b"), 5, 12, "launch: NAME and rules: FILE"},
        {LAUNCH("do: north, launch: south, rules: a.clp"), 5, 39, "cannot be an agent's name"},
        {LAUNCH("do: north, launch: b, rules: none.clp"), 5, 49, "cannot read the rules"},
    };
    CHECK_BAD(cases);
}

static void test_expectations(void)
{
    CU_ASSERT_EQUAL_FATAL(load(BASE "expect:\n"
                                    "  - {statistic: red.distance_m, at_least: 5}\n"
                                    "  - {statistic: robots.final.x_m, at_most: -1, from: 3}\n"
                                    "  - {sequence: [red stalled, red told x], within_s: 4}\n"
                                    "  - {never: red stalled}\n"
                                    "  - {never: 'red near puck 1'}\n",
                               NULL),
                          MU_OK);
    CU_ASSERT_EQUAL(e->expect_count, 5);
    CU_ASSERT(e->expect[0].at_least >= 5 && e->expect[0].at_most > 1e300);
    CU_ASSERT(e->expect[1].at_most <= -1 && e->expect[1].at_least < -1e300);
    CU_ASSERT_EQUAL(e->expect[2].sequence_count, 2);
    /* Each event once. */
    CU_ASSERT_EQUAL(e->events_count, 3);
    CU_ASSERT_EQUAL(experiment_event_find(e, "red stalled"), 0);
    CU_ASSERT_EQUAL(experiment_event_find(e, "red near puck 1"), 2);
    CU_ASSERT_EQUAL(experiment_event_find(e, "blue stalled"), EXPERIMENT_EVENTS_MAX);
    int robot;
    CU_ASSERT_EQUAL(experiment_statistic_find(e, "blue.stalls", &robot), STATISTIC_STALLS);
    CU_ASSERT_EQUAL(robot, 1);
    CU_ASSERT_EQUAL(experiment_statistic_find(e, "mail.lost", &robot), STATISTIC_LOST);
    CU_ASSERT_EQUAL(robot, EXPERIMENT_NO_ROBOT);
    CU_ASSERT_EQUAL(experiment_statistic_find(e, "robots.final.y_m", &robot), STATISTIC_FINAL_Y);
    CU_ASSERT_EQUAL(robot, EXPERIMENT_ALL_ROBOTS);
    CU_ASSERT_EQUAL(experiment_statistic_find(e, "red.mail.lost", &robot), STATISTICS);
    CU_ASSERT_EQUAL(experiment_statistic_find(e, "stalls", &robot), STATISTICS);
}

static void test_expectation_faults(void)
{
    static const struct bad_case cases[] = {
        {BASE "expect:\n  - {statistic: red.speed, at_least: 1}\n", 7, 17,
         "no statistic 'red.speed'"},
        {BASE "expect:\n  - {statistic: pink.stalls, at_least: 1}\n", 7, 17, "no statistic"},
        {BASE "expect:\n  - {statistic: red.stalls}\n", 7, 5, "expected at_least or at_most"},
        {BASE "expect:\n  - {statistic: red.stalls, at_least: 2, at_most: 1}\n", 7, 51,
         "no less than at_least, 2"},
        {BASE "expect:\n  - {statistic: red.stalls, at_least: 1, within: 3}\n", 7, 50,
         "'within' beside 'near' only"},
        {BASE "expect:\n  - {statistic: red.stalls, at_least: 1, from: 300}\n", 7, 48,
         "before the end"},
        {BASE "expect:\n  - {inside: arena, at_least: 3}\n", 7, 31,
         "'at_least' beside 'statistic' only"},
        {BASE "expect:\n  - {sequence: [red stalled, red likes blue]}\n", 7, 30,
         "near, at, stalled, told or fired"},
        {BASE "expect:\n  - {sequence: [pink stalled]}\n", 7, 17, "no robot 'pink'"},
        {BASE "expect:\n  - {sequence: []}\n", 7, 16, "expected"},
        {BASE "expect:\n  - {sequence: [red stalled], within_s: 0}\n", 7, 41, "more than 0 s"},
        {BASE "expect:\n  - {sequence: [red stalled], never: red stalled}\n", 7, 5,
         "expected one of near"},
        {BASE "expect:\n  - {never: red near blue}\n", 7, 13, "NAME near NAME METRES"},
        {BASE "expect:\n  - {never: 'red.stalls > x'}\n", 7, 13, "expected a number, not x"},
    };
    CHECK_BAD(cases);
}

static void test_limit_events(void)
{
    char text[EXPERIMENT_BYTES_MAX / 64];
    struct mu_text t;
    mu_text_init(&t, text, sizeof text);
    mu_text_add(&t, BASE "expect:\n");
    for (int i = 0; i < EXPERIMENT_EVENTS_MAX / 4; i++) {
        mu_text_format(&t,
                       "  - {sequence: [red told a%d, red told b%d, red told c%d, "
                       "red told d%d]}\n",
                       i, i, i, i);
    }
    CU_ASSERT_FALSE(t.cut);
    CU_ASSERT_EQUAL(load(text, NULL), MU_OK);
    mu_text_add(&t, "  - {never: red told more}\n");
    CU_ASSERT_EQUAL(load(text, NULL), MU_FAULT_FILE);
    CU_ASSERT_PTR_NOT_NULL(strstr(fault.text, "at most 64 different events"));
}

static void test_chaos(void)
{
    CU_ASSERT_EQUAL_FATAL(load(BASE
                               "brokers: [a, b]\nfree: true\nchaos:\n"
                               "  - {at: 10, push: red, force: [40, 0], for: 0.5}\n"
                               "  - {when: 'red.stalled_s > 2', place: red, pose: [1, 2, 90]}\n"
                               "  - {at: 1, block: blue, sensor: sonar, for: 3}\n"
                               "  - {at: 2, kill: broker, for: 2}\n"
                               "  - {at: 3, stop: red}\n"
                               "  - {at: 4, continue: red}\n"
                               "  - {at: 5, restart: b}\n"
                               "  - {at: 6, cut: [red, b], for: 1}\n"
                               "  - {at: 7, lose: [red, all], share: 0.1}\n"
                               "  - {at: 8, delay: [simulator, red], by_ms: 20}\n"
                               "  - {at: 9, stop: b, wall_s: 0.5}\n",
                               NULL),
                          MU_OK);
    static const char *const texts[] = {"push red with 40, 0 N for 0.5 s",
                                        "place red at 1, 2, 90 degrees when red.stalled_s > 2",
                                        "block blue's sonar for 3 s",
                                        "kill broker for 2 s",
                                        "stop red",
                                        "continue red",
                                        "restart b",
                                        "cut between red and b for 1 s",
                                        "lose between red and all: 10 % of the packets",
                                        "delay between simulator and red: 20 ms",
                                        "stop b for 0.5 s on the wall"};
    CU_ASSERT(e->free);
    CU_ASSERT_EQUAL_FATAL(e->chaos_count, sizeof texts / sizeof texts[0]);
    for (unsigned i = 0; i < e->chaos_count; i++) {
        CU_ASSERT_STRING_EQUAL(e->chaos[i].text, texts[i]);
        CU_ASSERT_EQUAL(e->chaos[i].mark.line, (int)i + 9);
    }
    CU_ASSERT_EQUAL(e->chaos[1].kind, CHAOS_PLACE);
    CU_ASSERT_STRING_EQUAL(e->chaos[9].whom, "red");
    CU_ASSERT_EQUAL(e->chaos[7].for_mark.column, 33);
    CU_ASSERT_EQUAL(e->chaos[9].for_mark.column, 5);
    CU_ASSERT_DOUBLE_EQUAL(e->chaos[10].wall_s, 0.5, 0);
}

#define CHAOS(text) BASE "chaos:\n  - {" text "}\n"

static void test_chaos_faults(void)
{
    static const struct bad_case cases[] = {
        {CHAOS("at: 1"), 7, 5, "expected one of push, place, block, kill"},
        {CHAOS("at: 1, kill: red, stop: red"), 7, 30, "expected only one of push"},
        {CHAOS("kill: red"), 7, 5, "expected either at: a time, or when: a condition"},
        {CHAOS("at: 1, when: red stalled, kill: red"), 7, 5, "expected either at"},
        {CHAOS("at: -1, kill: red"), 7, 10, "a time from 0"},
        {CHAOS("at: 121, kill: red"), 7, 10, "at most the duration"},
        {CHAOS("when: red likes, kill: red"), 7, 12, "near, at, stalled, told or fired"},
        {CHAOS("at: 1, kill: pink"), 7, 19, "no part 'pink'"},
        {CHAOS("at: 1, block: simulator, sensor: sonar"), 7, 20, "no robot 'simulator'"},
        {CHAOS("at: 1, block: red"), 7, 5, "expected 'sensor' beside 'block'"},
        {CHAOS("at: 1, block: red, sensor: nose"), 7, 33, "expected sonar, laser, camera"},
        {CHAOS("at: 1, push: red"), 7, 5, "expected force: [X, Y] or torque"},
        {CHAOS("at: 1, push: red, force: [1]"), 7, 31, "expected 2 in this list"},
        {CHAOS("at: 1, place: red"), 7, 5, "expected 'pose' beside 'place'"},
        {CHAOS("at: 1, kill: red, force: [1, 2]"), 7, 24, "'force' says nothing beside 'kill'"},
        {CHAOS("at: 1, cut: red"), 7, 18, "expected two parts"},
        {CHAOS("at: 1, cut: [red]"), 7, 18, "expected two parts"},
        {CHAOS("at: 1, cut: [red, red]"), 7, 18, "two different parts"},
        {CHAOS("at: 1, cut: [red, pink]"), 7, 24, "no part 'pink'"},
        {CHAOS("at: 1, cut: [all, red]"), 7, 19, "no part 'all'"},
        {CHAOS("at: 1, lose: [red, blue]"), 7, 5, "expected 'share' beside 'lose'"},
        {CHAOS("at: 1, lose: [red, blue], share: 1.5"), 7, 39, "a share of more than 0"},
        {CHAOS("at: 1, delay: [red, blue], by_ms: 0"), 7, 40, "a delay of more than 0"},
        {CHAOS("at: 1, stop: red, for: 0"), 7, 29, "a time of more than 0"},
        {CHAOS("at: 1, stop: red, wall_s: 0"), 7, 32, "a time of more than 0"},
        {CHAOS("at: 1, stop: red, wall_s: 3601"), 7, 32, "at most 3600 s"},
        {CHAOS("at: 1, stop: red, for: 1, wall_s: 1"), 7, 40, "for or wall_s, not both"},
        {CHAOS("at: 1, push: red, force: [1, 0], wall_s: 1"), 7, 39, "says nothing beside 'push'"},
    };
    CHECK_BAD(cases);
}

static void test_monitors(void)
{
    CU_ASSERT_EQUAL_FATAL(load(BASE "monitors:\n"
                                    "  - {rules: a.clp}\n"
                                    "  - {name: watch, rules: b.clp}\n"
                                    "  - {name: mine, program: /bin/sh}\n",
                               NULL),
                          MU_OK);
    CU_ASSERT_EQUAL_FATAL(e->monitors_count, 3);
    CU_ASSERT_STRING_EQUAL(e->monitors[0].name, "monitor");
    CU_ASSERT_PTR_NULL(e->monitors[0].program);
    CU_ASSERT(strncmp(e->monitors[1].rules, folder, strlen(folder)) == 0);
    CU_ASSERT_STRING_EQUAL(e->monitors[1].name, "watch");
    CU_ASSERT_PTR_NULL(e->monitors[2].rules);
    CU_ASSERT_EQUAL(e->monitors[2].mark.line, 9);
    /* A recording has no programs: nobody looks for them where it was unpacked. */
    experiment_root(folder);
    CU_ASSERT_EQUAL(load(BASE "monitors: [{program: /no/such/program}]\n", NULL), MU_OK);
    experiment_root("");
}

#define MONITOR(text) BASE "monitors:\n  - {" text "}\n"

static void test_monitor_faults(void)
{
    static const struct bad_case cases[] = {
        {MONITOR("name: watch"), 7, 5, "expected either rules: FILE, or program: FILE"},
        {MONITOR("rules: a.clp, program: /bin/sh"), 7, 5, "expected either rules: FILE"},
        {MONITOR("rules: none.clp"), 7, 13, "cannot read the rules"},
        {MONITOR("rules: ."), 7, 13, "expected a file as the rules, not the folder"},
        {MONITOR("program: none"), 7, 15, "cannot read the program"},
        {MONITOR("program: a.clp"), 7, 15, "expected a program that may be started"},
        {MONITOR("name: a b, rules: a.clp"), 7, 12, "'a b' cannot be a monitor's name"},
        {MONITOR("name: all, rules: a.clp"), 7, 12, "'all' cannot be a monitor's name"},
        {MONITOR("name: red, rules: a.clp"), 7, 12, "the name 'red' is taken"},
        {MONITOR("rules: a.clp}\n  - {rules: b.clp"), 8, 5, "the name 'monitor' is taken"},
        {MONITOR("rule: a.clp"), 7, 6, "unknown key 'rule'; expected one of: name, rules, program"},
    };
    CHECK_BAD(cases);
}

static void test_unreadable_files(void)
{
    CU_ASSERT_EQUAL(experiment_load(&e, "/nonexistent.yaml", NULL, 0, &fault), MU_FAULT_FILE);
    CU_ASSERT(strstr(fault.text, "No such file") != NULL);
    CU_ASSERT_EQUAL(experiment_load(&e, folder, NULL, 0, &fault), MU_FAULT_FILE);
    CU_ASSERT(strstr(fault.text, "Is a directory") != NULL);
}

/* A file with count items below a key; # in an item is its number. */
static char *repeat(const char *key, const char *item, size_t count)
{
    static char text[EXPERIMENT_BYTES_MAX + 16];
    struct mu_text out;
    mu_text_init(&out, text, sizeof text);
    mu_text_format(&out, "%s%s:\n",
                   strcmp(key, "robots") == 0 ? "world: a.world\nduration: 9\n" : BASE, key);
    for (size_t i = 0; i < count; i++) {
        const char *number = strchr(item, '#');
        mu_text_format(&out, "%.*s%zu%s", (int)(number - item), item, i, number + 1);
    }
    return text;
}

static void test_limits(void)
{
    static const struct {
        const char *key, *item;
        size_t max;
    } cases[] = {
        {"robots", "  - {name: r#, rules: a.clp}\n", MU_ROBOTS_MAX},
        {"observer", "  - {at: 1, do: red, line: (a#)}\n", EXPERIMENT_COMMANDS_MAX},
        {"expect", "  - {stall-max: 1#}\n", EXPERIMENT_EXPECTATIONS_MAX},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        CU_ASSERT_EQUAL(load(repeat(cases[i].key, cases[i].item, cases[i].max), NULL), MU_OK);
        CU_ASSERT_EQUAL(load(repeat(cases[i].key, cases[i].item, cases[i].max + 1), NULL),
                        MU_FAULT_FILE);
        CU_ASSERT(strstr(fault.text, "expected at most") != NULL);
    }
    char text[4096];
    struct mu_text out;
    static const char *const lists[] = {"groups", "services"};
    for (int i = 0; i < 4; i++) {
        mu_text_init(&out, text, sizeof text);
        mu_text_format(&out,
                       "world: a.world\nduration: 1\nrobots:\n  - name: a\n"
                       "    rules: a.clp\n    %s: [g",
                       lists[i / 2]);
        for (int k = 1; k < EXPERIMENT_GROUPS_MAX + i % 2; k++) {
            mu_text_format(&out, ", g%d", k);
        }
        mu_text_add(&out, "]\n");
        CU_ASSERT_EQUAL(load(text, NULL), i % 2 ? MU_FAULT_FILE : MU_OK);
    }
    for (int extra = 0; extra < 2; extra++) {
        mu_text_init(&out, text, sizeof text);
        mu_text_add(&out, "world: a.world\nduration: 1\nrobots:\n"
                          "  - name: a\n    rules: a.clp\n    globals:\n");
        for (int i = 0; i < EXPERIMENT_GLOBALS_MAX + extra; i++) {
            mu_text_format(&out, "      g%d: 1\n", i);
        }
        CU_ASSERT_EQUAL(load(text, NULL), extra ? MU_FAULT_FILE : MU_OK);
    }
}

static void test_limit_of_a_text(void)
{
    char text[8192];
    struct mu_text out;
    for (int extra = 0; extra < 2; extra++) {
        mu_text_init(&out, text, sizeof text);
        mu_text_format(&out, BASE "observer: [{at: 1, do: red, line: (a %0*d)}]\n", 4092 + extra,
                       7);
        CU_ASSERT_EQUAL(load(text, NULL), extra ? MU_FAULT_FILE : MU_OK);
    }
    CU_ASSERT(strstr(fault.text, "expected a text of at most 4096 bytes") != NULL);
    CU_ASSERT_EQUAL(fault.column, 35);
}

static void test_limit_bytes_and_overrides(void)
{
    static char text[EXPERIMENT_BYTES_MAX + 2];
    memset(text, '#', EXPERIMENT_BYTES_MAX + 1);
    memcpy(text, BASE, strlen(BASE));
    text[EXPERIMENT_BYTES_MAX] = '\0';
    CU_ASSERT_EQUAL(load(text, NULL), MU_OK);
    text[EXPERIMENT_BYTES_MAX] = '#';
    CU_ASSERT_EQUAL(load(text, NULL), MU_FAULT_FILE);
    CU_ASSERT(strstr(fault.text, "at most 1048576 bytes") != NULL);

    const char *many[EXPERIMENT_OVERRIDES_MAX + 1];
    for (size_t i = 0; i < EXPERIMENT_OVERRIDES_MAX + 1; i++) {
        many[i] = "seed=2";
    }
    CU_ASSERT_FATAL(file_write("test-1.yaml", BASE));
    CU_ASSERT_EQUAL(experiment_load(&e, path, many, EXPERIMENT_OVERRIDES_MAX, &fault), MU_OK);
    CU_ASSERT_EQUAL(experiment_load(&e, path, many, EXPERIMENT_OVERRIDES_MAX + 1, &fault),
                    MU_FAULT_USAGE);
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"defaults", test_defaults},
        {"everything", test_everything},
        {"what is started again", test_what_is_started_again},
        {"faults of the schema", test_schema_faults},
        {"faults of robots", test_robot_faults},
        {"agents without a body", test_agents},
        {"faults of agents", test_agent_faults},
        {"many robots", test_many_robots},
        {"faults of many robots", test_faults_of_many_robots},
        {"faults of the rest", test_other_faults},
        {"hosts", test_hosts},
        {"expectations", test_expectations},
        {"expectation faults", test_expectation_faults},
        {"limit: events", test_limit_events},
        {"chaos", test_chaos},
        {"chaos faults", test_chaos_faults},
        {"monitors", test_monitors},
        {"monitor faults", test_monitor_faults},
        {"unreadable files", test_unreadable_files},
        {"limits: lists", test_limits},
        {"limit: a text", test_limit_of_a_text},
        {"limits: bytes and overrides", test_limit_bytes_and_overrides},
        CU_TEST_INFO_NULL,
    };
    CU_SuiteInfo suites[] = {
        {"experiment/experiment", folder_make, folder_remove, NULL, NULL, tests},
        CU_SUITE_INFO_NULL};
    return suites_run(suites);
}
