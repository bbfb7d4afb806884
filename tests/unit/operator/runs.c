/* SPDX-License-Identifier: Apache-2.0 */
/*
 * The locks of live runs.  Every holder is a process of its own, because a lock lasts as long as
 * its process; XDG_RUNTIME_DIR is a folder of this test's own.
 */
#include "bus/bus.h"
#include "capture.h"
#include "operator/operator.h"
#include "suite.h"

#include <arpa/inet.h>
#include <CUnit/Basic.h>
#include <signal.h>
#include <stdlib.h>
#include <sys/prctl.h>
#include <sys/stat.h>
#include <sys/wait.h>

static char folder[] = "/tmp/muster-runs-XXXXXX";
static char inner[64];

struct told {
    mu_result result;
    int domain;
};

struct holder {
    pid_t pid;
    struct told told;
};

/* Starts a process that takes a domain and keeps it until it is killed. */
static void holder_start(struct holder *h, int wanted, const char *name)
{
    int ends[2];
    CU_ASSERT_EQUAL_FATAL(pipe(ends), 0);
    h->pid = fork();
    if (h->pid == 0) {
        prctl(PR_SET_PDEATHSIG, SIGKILL);
        struct told told = {.domain = -7};
        told.result = runs_take(wanted, name, &told.domain);
        ssize_t written = write(ends[1], &told, sizeof told);
        (void)written;
        pause();
        _exit(1);
    }
    close(ends[1]);
    CU_ASSERT_EQUAL_FATAL(read(ends[0], &h->told, sizeof h->told), sizeof h->told);
    close(ends[0]);
}

static void holder_kill(const struct holder *h)
{
    kill(h->pid, SIGKILL);
    CU_ASSERT_EQUAL(waitpid(h->pid, NULL, 0), h->pid);
}

static mu_result find(int *domain)
{
    *domain = -7;
    capture_begin();
    mu_result found = runs_find(domain);
    capture_end();
    return found;
}

static void expect_none(void)
{
    int domain;
    CU_ASSERT_EQUAL(find(&domain), MU_OK);
    CU_ASSERT_EQUAL(domain, 0);
    CU_ASSERT_STRING_EQUAL(captured, "");
}

static void test_none_lives(void)
{
    expect_none();
}

static void test_one_lives(void)
{
    struct holder h;
    int domain;
    holder_start(&h, -1, "follow");
    CU_ASSERT_EQUAL_FATAL(h.told.result, MU_OK);
    CU_ASSERT(h.told.domain >= RUNS_DOMAIN_FIRST && h.told.domain <= RUNS_DOMAIN_LAST);
    CU_ASSERT_EQUAL(find(&domain), MU_OK);
    CU_ASSERT_EQUAL(domain, h.told.domain);
    CU_ASSERT_STRING_EQUAL(captured, "");

    struct holder second;
    holder_start(&second, h.told.domain, "again");
    CU_ASSERT_EQUAL(second.told.result, MU_EXISTS);
    holder_kill(&second);
    CU_ASSERT_EQUAL(find(&domain), MU_OK);
    CU_ASSERT_EQUAL(domain, h.told.domain);

    int taken = h.told.domain;
    holder_kill(&h);
    expect_none(); /* its file is still there, and nobody's */
    holder_start(&h, taken, "later");
    CU_ASSERT_EQUAL(h.told.result, MU_OK);
    CU_ASSERT_EQUAL(h.told.domain, taken);
    holder_kill(&h);
}

static void test_several_live(void)
{
    struct holder a;
    struct holder b;
    int domain;
    char line[64];
    holder_start(&a, -1, "follow");
    holder_start(&b, -1, "a name\nwith a second line");
    CU_ASSERT(a.told.result == MU_OK && b.told.result == MU_OK);
    CU_ASSERT_NOT_EQUAL(a.told.domain, b.told.domain);
    CU_ASSERT_EQUAL(find(&domain), MU_EXISTS);
    CU_ASSERT(said("several runs live"));
    snprintf(line, sizeof line, "--domain %d  follow\n", a.told.domain);
    CU_ASSERT(said(line));
    snprintf(line, sizeof line, "--domain %d  a name\n", b.told.domain);
    CU_ASSERT(said(line));
    holder_kill(&a);
    CU_ASSERT_EQUAL(find(&domain), MU_OK);
    CU_ASSERT_EQUAL(domain, b.told.domain);
    holder_kill(&b);
    expect_none();
}

/* Another user's locks lie in another folder. */
static void other_begin(char *other, size_t size)
{
    snprintf(other, size, "%s/other", folder);
    CU_ASSERT_EQUAL_FATAL(mkdir(other, 0700), 0);
    setenv("XDG_RUNTIME_DIR", other, 1);
}

static void other_end(const char *other)
{
    char path[96];
    for (int d = RUNS_DOMAIN_FIRST; d <= RUNS_DOMAIN_LAST; d++) {
        snprintf(path, sizeof path, "%s/muster/domain-%d", other, d);
        (void)unlink(path); /* it was looked at, and is nobody's */
    }
    snprintf(path, sizeof path, "%s/muster", other);
    CU_ASSERT(rmdir(path) == 0 && rmdir(other) == 0);
}

/* His broker and simulator are not up yet. */
static void test_somebody_elses_run_has_another_domain(void)
{
    struct holder ours;
    struct holder theirs;
    char other[64];
    holder_start(&ours, -1, "follow");
    other_begin(other, sizeof other);
    holder_start(&theirs, -1, "follow");
    CU_ASSERT(ours.told.result == MU_OK && theirs.told.result == MU_OK);
    CU_ASSERT_NOT_EQUAL(ours.told.domain, theirs.told.domain);
    holder_kill(&ours);
    holder_kill(&theirs);
    other_end(other);
}

/* @return a socket that has a port of DDS; < 0: somebody else has it */
static int port_have(int domain, int index)
{
    int fd = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
    struct sockaddr_in address = {.sin_family = AF_INET,
                                  .sin_port = htons((uint16_t)bus_port(domain, index)),
                                  .sin_addr = {htonl(INADDR_LOOPBACK)}};
    if (bind(fd, (const struct sockaddr *)&address, sizeof address) != 0) {
        close(fd);
        return -1;
    }
    return fd;
}

/* A process that looks for a domain a hundred times. */
static pid_t looker_start(void)
{
    pid_t pid = fork();
    if (pid == 0) {
        for (int i = 0; i < 100; i++) {
            if (fork() == 0) {
                int domain;
                _exit(runs_take(-1, "look", &domain) == MU_OK ? 0 : 1);
            }
            wait(NULL);
        }
        _exit(0);
    }
    return pid;
}

/* Whose run has just begun has no broker yet; it starts while others look for a domain. */
static void test_a_look_takes_no_port_from_who_is_there(void)
{
    struct holder theirs;
    char other[64];
    int missed = 0;
    int tries = 0;
    holder_start(&theirs, -1, "follow");
    other_begin(other, sizeof other);
    pid_t looker = looker_start();
    for (; waitpid(looker, NULL, WNOHANG) == 0; tries++) {
        int fd = port_have(theirs.told.domain, tries % 5);
        missed += fd < 0;
        if (fd >= 0) {
            close(fd);
        }
    }
    CU_ASSERT(tries > 0);
    CU_ASSERT_EQUAL(missed, 0);
    holder_kill(&theirs);
    other_end(other);
}

static void test_a_stale_file_is_no_run(void)
{
    char path[96];
    snprintf(path, sizeof path, "%s/domain-5", inner);
    FILE *file = fopen(path, "w");
    CU_ASSERT_PTR_NOT_NULL_FATAL(file);
    fputs("old\n", file);
    fclose(file);
    expect_none();
}

/* A domain whose ports somebody uses is not free, lock or no lock. */
static void test_ports_in_use(void)
{
    struct holder h;
    holder_start(&h, -1, "probe"); /* finds a domain that is free */
    int taken = h.told.domain;
    holder_kill(&h);
    int fd = port_have(taken, 1);
    CU_ASSERT_FATAL(fd >= 0);
    holder_start(&h, taken, "follow");
    CU_ASSERT_EQUAL(h.told.result, MU_BUSY);
    holder_kill(&h);
    expect_none();
    holder_start(&h, -1, "follow");
    CU_ASSERT_EQUAL(h.told.result, MU_OK);
    CU_ASSERT_NOT_EQUAL(h.told.domain, taken);
    holder_kill(&h);
    close(fd);
}

/* One process can hold them all, as each lock is a file of its own; others may have some. */
static void test_limit_domains(void)
{
    pid_t pid = fork();
    if (pid == 0) {
        int domain = 0;
        int taken = 0;
        while (taken < 1000 && runs_take(-1, "all", &domain) == MU_OK) {
            taken++;
        }
        bool all = taken > 0 && taken <= RUNS_DOMAIN_LAST;
        _exit(all && runs_take(-1, "more", &domain) != MU_OK ? 0 : 1);
    }
    int status = -1;
    CU_ASSERT_EQUAL(waitpid(pid, &status, 0), pid);
    CU_ASSERT_EQUAL(status, 0);
}

/* @return whether another process of ours can take a domain */
static bool another_takes(void)
{
    int status = -1, domain = -7;
    pid_t pid = fork();
    if (pid == 0) {
        _exit(runs_take(-1, "follow", &domain) == MU_OK ? 0 : 1);
    }
    return waitpid(pid, &status, 0) == pid && status == 0;
}

/* A folder below /tmp stands in for it. */
static void test_a_folder_that_cannot_be(void)
{
    char file[64];
    snprintf(file, sizeof file, "%s/file", folder);
    CU_ASSERT_EQUAL_FATAL(mkdir(file, 0700), 0);
    setenv("XDG_RUNTIME_DIR", file, 1);
    char link[96];
    snprintf(link, sizeof link, "%s/muster", file);
    CU_ASSERT_EQUAL(symlink(folder, link), 0); /* where somebody else wants it */
    CU_ASSERT(another_takes());
    struct stat info;
    CU_ASSERT(lstat(link, &info) == 0 && S_ISLNK(info.st_mode));
    CU_ASSERT_EQUAL(unlink(link), 0);
    CU_ASSERT_EQUAL(rmdir(file), 0);
    CU_ASSERT(another_takes()); /* not there at all */
}

static void set_up(void)
{
    setenv("XDG_RUNTIME_DIR", folder, 1);
    alarm(60);
}

static int folder_make(void)
{
    if (!mkdtemp(folder)) {
        return 1;
    }
    snprintf(inner, sizeof inner, "%s/muster", folder);
    return 0;
}

static int folder_remove(void)
{
    for (int domain = 0; domain <= RUNS_DOMAIN_LAST; domain++) {
        char path[96];
        snprintf(path, sizeof path, "%s/domain-%d", inner, domain);
        (void)unlink(path);
    }
    return rmdir(inner) || rmdir(folder);
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"none lives", test_none_lives},
        {"one lives", test_one_lives},
        {"several live", test_several_live},
        {"somebody else's run has another domain", test_somebody_elses_run_has_another_domain},
        {"a look takes no port from who is there", test_a_look_takes_no_port_from_who_is_there},
        {"a stale file is no run", test_a_stale_file_is_no_run},
        {"ports in use", test_ports_in_use},
        {"limit: domains", test_limit_domains},
        {"a folder that cannot be", test_a_folder_that_cannot_be},
        CU_TEST_INFO_NULL,
    };
    CU_SuiteInfo suites[] = {{"operator/runs", folder_make, folder_remove, set_up, NULL, tests},
                             CU_SUITE_INFO_NULL};
    return suites_run(suites);
}
