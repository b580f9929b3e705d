/* Preloaded in sanitizer builds: libraries stay loaded until the process ends. Vulkan drivers leave blocks behind when
 * they are closed, and the leak checker can name, and so excuse, only a library that is still there. */
int dlclose(void *library);

__attribute__((visibility("default"))) int dlclose(void *library)
{
    (void)library;
    return 0;
}
