#ifndef CLR_TABLE_SIZE
/* Entries of a table that lanes read by index (lanes.clh, table_real). */
#define CLR_TABLE_SIZE 16
#endif
