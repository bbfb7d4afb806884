/* SPDX-License-Identifier: Apache-2.0 */
#include "bus/local.h"

#include "bus/cdr.h"
#include "bus/local_frame.h"
#include "bus/local_token.h"
#include "bus/topics.h"

#include <errno.h>
#include <fcntl.h>

/* A connection begins with so much room, has up to ROOM where much comes at once, and more only for
 * a sample that is larger.  So many samples of one are taken, and then some of the next. */
enum { ROOM_FIRST = 1 << 12, ROOM = 1 << 16, AT_ONCE = 8 };

enum local_state {
    INPUT_ACCEPTED, /* it has not said yet who it is */
    INPUT_ANSWERED, /* and not yet that it has the answer */
    INPUT_MET,
    INPUT_PAUSED, /* its room is full of samples that are not taken yet */
    INPUT_ENDED,  /* and the program is to be told, behind what came before */
    INPUT_OVER,
};

struct local_input {
    struct local_source source;
    struct local_input *next; /* of the door */
    struct local_input *next_queued;
    struct bus_reader *reader;
    enum local_state state;
    bool queued; /* it has something for the program */
    bool met;    /* it was, or is */
    struct local_hello hello;
    dds_instance_handle_t writer; /* on DDS; 0: not known */
    char *data;
    size_t size, head, tail;
    size_t counted;  /* up to here samples were counted */
    uint32_t frames; /* whole ones from head on */
};

struct local_door {
    struct local_source source;
    struct local_door *next; /* of the bus */
    struct bus_reader *reader;
    struct local_input *inputs;
    struct local_input *first, *last; /* those that have something, in the order of its arrival */
    uint32_t looked; /* of the reader's writers_ever, when it last looked for those on DDS */
    int spare;       /* a descriptor for those that are to be refused when none is left */
};

/* --- the door --------------------------------------------------------------------------------- */

void local_reader_open(struct bus_reader *r, dds_qos_t *qos)
{
    struct local_token token;
    bool wanted = r->bus->local && topic_table[r->topic].local;
    int fd = wanted ? local_listen(&token, r->bus->participant) : -1;
    if (fd < 0) {
        return; /* all comes by DDS */
    }
    struct local_door *door = local_memory(sizeof *door);
    *door = (struct local_door){.source = {LOCAL_DOOR, fd},
                                .next = r->bus->doors,
                                .reader = r,
                                .spare = open("/dev/null", O_RDONLY | O_CLOEXEC)};
    local_watch(r->bus, &door->source, EPOLLIN);
    dds_qset_userdata(qos, &token, sizeof token);
    r->door = r->bus->doors = door;
}

static void input_close(struct local_input *in, enum local_state state)
{
    local_unwatch(in->reader->bus, &in->source);
    in->state = state;
}

static void input_free(struct local_input *in)
{
    input_close(in, INPUT_OVER);
    dds_free(in->data);
    dds_free(in);
}

/* Notes which of the connections are of writers that DDS has found.  @return the first one */
static struct local_input *inputs_look(struct local_door *door)
{
    struct bus_reader *r = door->reader;
    dds_instance_handle_t writers[BUS_ENDPOINTS_MAX];
    uint32_t ever = atomic_load(&r->writers_ever);
    dds_return_t count = door->looked != ever
                             ? dds_get_matched_publications(r->reader, writers, BUS_ENDPOINTS_MAX)
                             : 0;
    door->looked = ever;
    for (dds_return_t i = 0; i < count && i < BUS_ENDPOINTS_MAX; i++) {
        dds_guid_t who[2];
        bool writes = bus_writer_identify(r, writers[i], who);
        for (struct local_input *in = writes ? door->inputs : NULL; in; in = in->next) {
            bool is_its = in->met && (memcmp(&in->hello.writer, &who[0], sizeof who[0]) == 0 ||
                                      memcmp(&in->hello.writer, &who[1], sizeof who[1]) == 0);
            in->writer = is_its ? writers[i] : in->writer;
        }
    }
    return door->inputs;
}

/* @return whether DDS may still bring samples of its writer */
static bool is_on_dds(const struct local_input *in)
{
    dds_guid_t who[2];
    (void)inputs_look(in->reader->door);
    return in->writer && bus_writer_identify(in->reader, in->writer, who);
}

static void ended_free(struct local_door *door)
{
    struct local_input *in;
    for (struct local_input **at = &door->inputs; (in = *at);) {
        if (in->state != INPUT_OVER || in->queued || is_on_dds(in)) {
            at = &in->next;
        } else {
            *at = in->next;
            input_free(in);
        }
    }
}

/* One that cannot be taken is told so, or its samples would lie there for ever. */
static void accept_refuse(struct local_door *door)
{
    close(door->spare);
    (void)close(accept4(door->source.fd, NULL, NULL, SOCK_CLOEXEC)); /* of -1 nothing */
    door->spare = open("/dev/null", O_RDONLY | O_CLOEXEC);
    door->reader->bus->local_refused++;
}

static void door_accept(struct bus *bus, struct local_door *door)
{
    int fd;
    ended_free(door);
    while ((fd = accept4(door->source.fd, NULL, NULL, SOCK_NONBLOCK | SOCK_CLOEXEC)) >= 0) {
        if (!local_is_ours(fd)) {
            close(fd);
            bus->local_refused++;
            continue;
        }
        struct local_input *in = local_memory(sizeof *in);
        *in = (struct local_input){.source = {LOCAL_INPUT, fd},
                                   .next = door->inputs,
                                   .reader = door->reader,
                                   .data = local_memory(ROOM_FIRST),
                                   .size = ROOM_FIRST};
        door->inputs = in;
        local_watch(bus, &in->source, EPOLLIN);
    }
    if ((errno == EMFILE || errno == ENFILE) && door->spare >= 0) {
        accept_refuse(door);
    }
}

static void door_free(struct bus *bus, struct local_door *door)
{
    local_unwatch(bus, &door->source);
    close(door->spare);
    for (struct local_input *in = door->inputs, *next; in; in = next) {
        next = in->next;
        bus->local_frames -= in->frames + (in->state == INPUT_ENDED);
        input_free(in);
    }
    dds_free(door);
}

void local_reader_close(struct bus_reader *r)
{
    struct local_door **at = &r->bus->doors;
    while (*at && *at != r->door) {
        at = &(*at)->next;
    }
    if (*at) {
        *at = r->door->next;
        door_free(r->bus, r->door);
        r->door = NULL;
    }
}

void local_readers_close(struct bus *bus)
{
    for (struct local_door *door; (door = bus->doors);) {
        bus->doors = door->next;
        door_free(bus, door);
    }
}

/* --- reading ---------------------------------------------------------------------------------- */

static size_t frame_size(const struct local_input *in, size_t at)
{
    uint32_t size;
    memcpy(&size, in->data + at, sizeof size);
    return size;
}

static void queue_put(struct local_door *door, struct local_input *in)
{
    if (!in->queued) {
        in->queued = true;
        in->next_queued = NULL;
        *(door->first ? &door->last->next_queued : &door->first) = in;
        door->last = in;
    }
}

/* There is a sample more for the program, or an end. */
static void news_note(struct local_input *in)
{
    in->reader->bus->local_frames++;
    queue_put(in->reader->door, in);
}

static void frame_drop(struct local_input *in)
{
    in->head += frame_size(in, in->head);
    in->frames--;
    in->reader->bus->local_frames--;
}

static void input_end(struct local_input *in)
{
    input_close(in, in->met ? INPUT_ENDED : INPUT_OVER);
    if (in->met) {
        in->reader->connected--;
        news_note(in);
    }
}

/* @return whether it may go on: whole samples are counted, and none is no sample */
static bool frames_count(struct local_input *in)
{
    while (in->tail - in->counted >= CDR_FRAME_HEAD) {
        size_t size = frame_size(in, in->counted);
        if (size < CDR_FRAME_HEAD || size % CDR_FRAME_HEAD != 0) {
            in->reader->bus->malformed++;
            return false;
        }
        if (in->tail - in->counted < size) {
            break;
        }
        in->counted += size;
        in->frames++;
        news_note(in);
    }
    /* A reader that keeps the last sample alone has no use for those before. */
    while (!topic_table[in->reader->topic].keeps_all && in->frames > 1) {
        frame_drop(in);
    }
    return true;
}

/* @return whether it has said who it is, was answered, and knows */
static bool input_meet(struct local_input *in)
{
    if (in->state == INPUT_ACCEPTED && in->tail >= LOCAL_HELLO_FIRST) {
        memcpy(&in->hello, in->data, LOCAL_HELLO_FIRST);
        if (in->hello.mark != LOCAL_HELLO_MARK ||
            send(in->source.fd, "", 1, MSG_NOSIGNAL | MSG_DONTWAIT) != 1) {
            in->reader->bus->local_refused++;
            input_end(in);
            return false;
        }
        in->state = INPUT_ANSWERED;
    }
    if (in->state == INPUT_ANSWERED && in->tail >= sizeof in->hello) {
        memcpy(&in->hello, in->data, sizeof in->hello);
        in->head = in->counted = sizeof in->hello;
        in->state = INPUT_MET;
        in->met = true;
        in->reader->connected++;
        in->reader->door->looked--;
    }
    return in->met;
}

static void room_make(struct local_input *in)
{
    if (in->head > 0) {
        memmove(in->data, in->data + in->head, in->tail - in->head);
        in->tail -= in->head;
        in->counted -= in->head;
        in->head = 0;
    }
    bool is_large = in->tail == 0 && in->size > ROOM;
    bool is_small = in->tail == in->size && (in->frames == 0 || in->size < ROOM);
    if (is_large || is_small) {
        in->size = is_large ? ROOM : in->size * 2;
        in->data = dds_realloc(in->data, in->size);
    }
}

static void input_pause(struct local_input *in, bool pause)
{
    in->state = pause ? INPUT_PAUSED : INPUT_MET;
    local_change(in->reader->bus, &in->source, pause ? 0 : EPOLLIN);
}

/* @return whether its room was filled: more may be there */
static bool input_fill(struct local_input *in)
{
    if (in->head == in->tail || in->tail == in->size) {
        room_make(in);
    }
    size_t room = in->size - in->tail;
    if (room == 0) {
        input_pause(in, true);
        return false;
    }
    ssize_t n = recv(in->source.fd, in->data + in->tail, room, MSG_DONTWAIT);
    in->tail += n > 0 ? (size_t)n : 0;
    bool ends = n == 0 || (n < 0 && errno != EAGAIN && errno != EINTR);
    if (ends || (n > 0 && input_meet(in) && !frames_count(in))) {
        input_end(in);
    }
    return n == (ssize_t)room && in->source.fd >= 0;
}

/* Where the last sample alone counts, it is the last that is there now. */
static void input_read(struct local_input *in)
{
    while (input_fill(in) && !topic_table[in->reader->topic].keeps_all) {
    }
}

void local_reader_ready(struct bus *bus, struct local_source *source)
{
    source->kind == LOCAL_DOOR ? door_accept(bus, (struct local_door *)source)
                               : input_read((struct local_input *)source);
}

/* --- taking ----------------------------------------------------------------------------------- */

/* @return whether the bytes were a sample of the topic */
static bool frame_decode(struct local_input *in, void *sample)
{
    const uint32_t *ops = topic_table[in->reader->topic].descriptor->m_ops;
    const char *frame = in->data + in->head;
    bool whole =
        cdr_take(sample, frame + CDR_FRAME_HEAD, frame_size(in, in->head) - CDR_FRAME_HEAD, ops);
    in->reader->bus->malformed += !whole;
    frame_drop(in);
    return whole;
}

/* @return how many samples there are then: at most AT_ONCE more, and behind the last one the end */
static int32_t input_take(struct local_input *in, int32_t count)
{
    struct bus_reader *r = in->reader;
    for (int i = 0; i < AT_ONCE && count < BUS_BATCH && in->frames > 0; i++) {
        r->states[count] = r->fates[count] = BUS_DATA;
        count += frame_decode(in, r->samples[count]);
    }
    if (in->frames == 0 && in->state == INPUT_PAUSED) {
        input_pause(in, false);
    }
    if (in->frames == 0 && in->state == INPUT_ENDED && count < BUS_BATCH) {
        r->states[count] = r->fates[count] = BUS_LOST;
        count++;
        in->state = INPUT_OVER;
        r->bus->local_frames--;
    }
    return count;
}

int32_t local_take(struct bus_reader *r)
{
    struct local_door *door = r->door;
    int32_t count = 0;
    struct local_input *last = door ? door->last : NULL;
    for (struct local_input *in; door && (in = door->first) && count < BUS_BATCH;) {
        door->first = in->next_queued;
        in->queued = false;
        count = input_take(in, count);
        if (in->frames > 0 || in->state == INPUT_ENDED) {
            queue_put(door, in);
        }
        if (in == last) {
            break; /* each once */
        }
    }
    return count;
}

bool local_has(struct bus_reader *r, const dds_sample_info_t *info)
{
    const struct local_input *in = r->door ? inputs_look(r->door) : NULL;
    while (in && in->writer != info->publication_handle) {
        in = in->next;
    }
    return in && info->source_timestamp > in->hello.since_ns;
}
