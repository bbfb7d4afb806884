/* SPDX-License-Identifier: Apache-2.0 */
/* A child of this test sends packets to itself; the table says what becomes of them. */
#include "bus/traffic.h"
#include "core/paths.h"
#include "suite.h"

#include <arpa/inet.h>
#include <CUnit/Basic.h>
#include <poll.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/uio.h>
#include <sys/wait.h>
#include <unistd.h>

#define CHILD "MUSTER_TEST_CHILD" /* in the environment of this program when it is the child */

enum { PACKETS = 200, QUIET_MS = 300 };

static struct traffic *table;

/* --- the child -------------------------------------------------------------------------------- */

static int socket_bind(struct sockaddr_in *address)
{
    socklen_t len = sizeof *address;
    int fd = socket(AF_INET, SOCK_DGRAM, 0);
    *address = (struct sockaddr_in){.sin_family = AF_INET, .sin_addr = {htonl(INADDR_LOOPBACK)}};
    bool good = bind(fd, (struct sockaddr *)address, sizeof *address) == 0;
    good = good && getsockname(fd, (struct sockaddr *)address, &len) == 0;
    return good ? fd : -1;
}

static int packets_take(int fd)
{
    struct pollfd wait = {.fd = fd, .events = POLLIN};
    char bytes[64];
    int count = 0;
    while (poll(&wait, 1, QUIET_MS) > 0) {
        count += recv(fd, bytes, sizeof bytes, 0) == 10 && memcmp(bytes, "helloworld", 10) == 0;
    }
    return count;
}

/* @return how many packets arrived */
static int child_live(void)
{
    struct sockaddr_in to;
    char hello[] = "hello", world[] = "world";
    struct iovec pieces[] = {{hello, 5}, {world, 5}};
    struct msghdr message = {
        .msg_name = &to, .msg_namelen = sizeof to, .msg_iov = pieces, .msg_iovlen = 2};
    int fd = socket_bind(&to);
    for (int i = 0; i < PACKETS; i++) {
        if (sendmsg(fd, &message, 0) != 10) {
            return 255;
        }
    }
    return packets_take(fd);
}

/* --- the test --------------------------------------------------------------------------------- */

static int child_run(unsigned part)
{
    char program[] = "/proc/self/exe", topic[] = "traffic";
    char *const argv[] = {program, topic, NULL};
    int status;
    traffic_child(part);
    pid_t pid = fork();
    if (pid == 0) {
        setenv(CHILD, "1", 1);
        setenv("ASAN_OPTIONS", "verify_asan_link_order=0", 1); /* the preloaded library is first */
        execv(program, argv);
        _exit(255);
    }
    CU_ASSERT_FATAL(waitpid(pid, &status, 0) == pid && WIFEXITED(status));
    return WEXITSTATUS(status);
}

static void test_untouched(void)
{
    CU_ASSERT_EQUAL(child_run(1), PACKETS);
    traffic_set(table, 2, 2, 1, 0); /* others' */
    CU_ASSERT_EQUAL(child_run(1), PACKETS);
    CU_ASSERT_EQUAL(traffic_struck(table), 0);
    traffic_set(table, 2, 2, 0, 0);
}

static void test_lost(void)
{
    traffic_set(table, 3, 3, 1, 0);
    CU_ASSERT_EQUAL(child_run(3), 0);
    CU_ASSERT_EQUAL(traffic_struck(table), PACKETS);
    traffic_set(table, 3, 3, 0.25, 0);
    int came = child_run(3);
    CU_ASSERT(came > PACKETS / 2 && came < PACKETS); /* a quarter of 200 is not 0 and not 100 */
    CU_ASSERT_EQUAL(traffic_struck(table), (uint64_t)(2 * PACKETS - came));
    CU_ASSERT_EQUAL(child_run(3), came); /* the same chance for the n-th packet */
    traffic_set(table, 3, 3, 0, 0);
    CU_ASSERT_EQUAL(child_run(3), PACKETS);
}

static void test_late(void)
{
    uint64_t before = traffic_struck(table);
    traffic_set(table, 4, 4, 0, 50);
    CU_ASSERT_EQUAL(child_run(4), PACKETS);
    CU_ASSERT_EQUAL(traffic_struck(table) - before, PACKETS);
}

int main(void)
{
    if (getenv(CHILD)) {
        return child_live();
    }
    CU_TestInfo tests[] = {
        {"untouched", test_untouched},
        {"lost", test_lost},
        {"late", test_late},
        CU_TEST_INFO_NULL,
    };
    char library[4096];
    if (!mu_path_program(library, sizeof library, TRAFFIC_LIBRARY) ||
        traffic_make(&table, 7, library) != MU_OK) {
        return EXIT_FAILURE;
    }
    return suite_run("bus/traffic", tests);
}
