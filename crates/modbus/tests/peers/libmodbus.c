/* Peers of the examples `server` and `peer`, with libmodbus 3.1:
 *   cc libmodbus.c -o libmodbus_peer $(pkg-config --cflags --libs libmodbus)
 *   libmodbus_peer server PORT            a server with 64 values in each table; then: example `peer`
 *   libmodbus_peer client PORT COUNT      random requests to the example `server`
 */
#include <errno.h>
#include <modbus.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define SIZE 64

static int serve(int port) {
    modbus_t *bus = modbus_new_tcp("127.0.0.1", port);
    modbus_mapping_t *tables = modbus_mapping_new(SIZE, SIZE, SIZE, SIZE);
    int listener = modbus_tcp_listen(bus, 1);
    if (!tables || listener < 0) return 1;
    for (;;) {
        uint8_t request[MODBUS_TCP_MAX_ADU_LENGTH];
        if (modbus_tcp_accept(bus, &listener) < 0) return 1;
        int length;
        while ((length = modbus_receive(bus, request)) >= 0) modbus_reply(bus, request, length, tables);
        modbus_close(bus);
    }
}

static void fail(int number, const char *what) {
    fprintf(stderr, "request %d: %s: %s\n", number, what, modbus_strerror(errno));
    exit(1);
}

static int ask(int port, int count) {
    modbus_t *bus = modbus_new_tcp("127.0.0.1", port);
    uint8_t coils[SIZE] = {0}, bits[SIZE], found[SIZE];
    uint16_t holding[SIZE] = {0}, words[SIZE], registers[SIZE];
    modbus_set_slave(bus, 1);
    if (modbus_connect(bus)) fail(-1, "connect");
    if (modbus_write_bits(bus, 0, SIZE, coils) < 0) fail(-1, "coils");
    if (modbus_write_registers(bus, 0, SIZE, holding) < 0) fail(-1, "holding registers");
    srand(1);
    for (int number = 0; number < count; number++) {
        int first = rand() % SIZE, size = 1 + rand() % (SIZE - first), done = 0;
        for (int i = 0; i < size; i++) {
            words[i] = rand();
            bits[i] = words[i] % 2;
        }
        switch (number % 9) {
        case 0:
            done = modbus_read_bits(bus, first, size, found);
            if (memcmp(found, coils + first, size)) fail(number, "coils");
            break;
        case 1:
            done = modbus_read_input_bits(bus, first, size, found);
            for (int i = 0; i < size; i++)
                if (found[i] != ((first + i) % 3 == 0)) fail(number, "discrete inputs");
            break;
        case 2:
            done = modbus_read_registers(bus, first, size, registers);
            if (memcmp(registers, holding + first, 2 * size)) fail(number, "holding registers");
            break;
        case 3:
            done = modbus_read_input_registers(bus, first, size, registers);
            for (int i = 0; i < size; i++)
                if (registers[i] != 1000 + first + i) fail(number, "input registers");
            break;
        case 4:
            coils[first] = bits[0];
            size = done = modbus_write_bit(bus, first, bits[0]);
            break;
        case 5:
            holding[first] = words[0];
            size = done = modbus_write_register(bus, first, words[0]);
            break;
        case 6:
            memcpy(coils + first, bits, size);
            done = modbus_write_bits(bus, first, size, bits);
            break;
        case 7:
            memcpy(holding + first, words, 2 * size);
            done = modbus_write_registers(bus, first, size, words);
            break;
        default:
            memcpy(holding + first, words, 2 * size);
            done = modbus_write_and_read_registers(bus, first, size, words, first, size, registers);
            if (memcmp(registers, words, 2 * size)) fail(number, "registers");
        }
        if (done != size || done < 1) fail(number, "refused");
    }
    if (modbus_read_registers(bus, SIZE - 1, 2, registers) != -1 || errno != EMBXILADD) fail(count, "no exception 2");
    printf("%d requests answered as expected\n", count);
    return 0;
}

int main(int argc, char **argv) {
    if (argc == 3 && !strcmp(argv[1], "server")) return serve(atoi(argv[2]));
    if (argc == 4 && !strcmp(argv[1], "client")) return ask(atoi(argv[2]), atoi(argv[3]));
    fputs("expected: server PORT, or client PORT COUNT\n", stderr);
    return 2;
}
