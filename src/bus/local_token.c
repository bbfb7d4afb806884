/* SPDX-License-Identifier: Apache-2.0 */
#include "bus/local_token.h"

#include <string.h>
#include <sys/random.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

static const char token_mark[8] = "mulocal1";

/* @return whether the system had random digits */
static bool token_draw(struct local_token *token)
{
    unsigned char random[sizeof token->name / 2];
    memcpy(token->mark, token_mark, sizeof token_mark);
    bool drawn = getrandom(random, sizeof random, 0) == (ssize_t)sizeof random;
    for (size_t i = 0; i < sizeof token->name; i++) {
        token->name[i] = "0123456789abcdef"[random[i / 2] >> i % 2 * 4 & 15];
    }
    return drawn;
}

/* Of an abstract name the first byte is 0.  @return its length */
static socklen_t token_address(const struct local_token *token, struct sockaddr_un *address)
{
    *address = (struct sockaddr_un){.sun_family = AF_UNIX};
    memcpy(address->sun_path + 1, token, sizeof *token);
    return (socklen_t)(offsetof(struct sockaddr_un, sun_path) + 1 + sizeof *token);
}

int local_listen(struct local_token *token, dds_entity_t participant)
{
    struct sockaddr_un address;
    if (dds_get_guid(participant, &token->owner) != DDS_RETCODE_OK || !token_draw(token)) {
        return -1;
    }
    socklen_t len = token_address(token, &address);
    int fd = socket(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
    if (fd >= 0 &&
        (bind(fd, (const struct sockaddr *)&address, len) != 0 || listen(fd, SOMAXCONN) != 0)) {
        close(fd);
        fd = -1;
    }
    return fd;
}

int local_connect(const struct local_token *token, int room)
{
    struct sockaddr_un address;
    socklen_t len = token_address(token, &address);
    int fd = socket(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
    (void)setsockopt(fd, SOL_SOCKET, SO_SNDBUF, &room, sizeof room); /* or what the system allows */
    if (fd >= 0 && connect(fd, (const struct sockaddr *)&address, len) != 0) {
        close(fd);
        fd = -1;
    }
    return fd;
}

bool local_token_find(const dds_builtintopic_endpoint_t *reader, struct local_token *token)
{
    void *data = NULL;
    size_t size = 0;
    bool found = reader->qos && dds_qget_userdata(reader->qos, &data, &size) &&
                 size == sizeof *token && memcmp(data, token_mark, sizeof token_mark) == 0;
    if (found) {
        memcpy(token, data, sizeof *token);
    }
    dds_free(data);
    return found && memcmp(&token->owner, &reader->participant_key, sizeof token->owner) == 0;
}

bool local_endpoint_names(const dds_builtintopic_endpoint_t *endpoint, const char *partition)
{
    uint32_t count = 0;
    char **names = NULL;
    bool found = false;
    if (endpoint->qos && dds_qget_partition(endpoint->qos, &count, &names)) {
        for (uint32_t i = 0; i < count; i++) {
            found = found || strcmp(names[i], partition) == 0;
            dds_free(names[i]);
        }
        dds_free(names);
    }
    return found;
}

bool local_is_ours(int fd)
{
    struct ucred peer;
    socklen_t len = sizeof peer;
    return getsockopt(fd, SOL_SOCKET, SO_PEERCRED, &peer, &len) == 0 && peer.uid == geteuid();
}
