/* Counts the messages that a processor sends, and their bytes: `mpicc -shared -fPIC count_mpi.c -o count_mpi.so`, then
 * LD_PRELOAD it. At MPI_Finalize each processor prints a line: count_mpi MESSAGES BYTES. */
#include <mpi.h>
#include <stdio.h>

static long long messages, bytes;

static void sent(int count, MPI_Datatype type, int to) {
  int size;
  if (to == MPI_PROC_NULL) return;
  PMPI_Type_size(type, &size);
  ++messages;
  bytes += (long long)size * count;
}
int MPI_Send(const void* buffer, int n, MPI_Datatype type, int to, int tag, MPI_Comm comm) {
  sent(n, type, to);
  return PMPI_Send(buffer, n, type, to, tag, comm);
}
int MPI_Rsend(const void* buffer, int n, MPI_Datatype type, int to, int tag, MPI_Comm comm) {
  sent(n, type, to);
  return PMPI_Rsend(buffer, n, type, to, tag, comm);
}
int MPI_Isend(const void* buffer, int n, MPI_Datatype type, int to, int tag, MPI_Comm comm, MPI_Request* request) {
  sent(n, type, to);
  return PMPI_Isend(buffer, n, type, to, tag, comm, request);
}
int MPI_Sendrecv(const void* out, int n, MPI_Datatype type, int to, int tag, void* in, int m, MPI_Datatype in_type,
                 int from, int in_tag, MPI_Comm comm, MPI_Status* status) {
  sent(n, type, to);
  return PMPI_Sendrecv(out, n, type, to, tag, in, m, in_type, from, in_tag, comm, status);
}
int MPI_Finalize(void) {
  printf("count_mpi %lld %lld\n", messages, bytes);
  fflush(stdout);
  return PMPI_Finalize();
}
