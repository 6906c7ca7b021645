/* A shared library that is no plug-in. */
int proleg_something_else(void);
int proleg_something_else(void) { return 1; }
