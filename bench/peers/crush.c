/* TestU01 on 32-bit words from standard input. Debian: apt install libtestu01-0-dev; gcc -O2 -I/usr/include/testu01 crush.c -o crush -ltestu01 */
#include <bbattery.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unif01.h>

static unsigned int words[1 << 16];
static size_t at, have;

static unsigned int next(void) {
    if (at == have) {
        have = fread(words, sizeof words[0], 1 << 16, stdin);
        at = 0;
        if (have == 0) {
            fputs("no more numbers\n", stderr);
            exit(1);
        }
    }
    return words[at++];
}

int main(int count, char **arguments) {
    unif01_Gen *generator = unif01_CreateExternGenBits("unbiased's streams", next);
    if (count > 1 && strcmp(arguments[1], "crush") == 0)
        bbattery_Crush(generator);
    else
        bbattery_SmallCrush(generator);
    return 0;
}
