#include <stdio.h>

#include "hewn/hewn.h"

int main(void)
{
    printf("hewn %s\n", hewn_version());
    return 0;
}
