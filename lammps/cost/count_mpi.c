/* Counts what a processor sends by MPI, and its own time outside MPI, which waiting is no part of:
 * mpicc -shared -fPIC -O2 count_mpi.c -o count_mpi.so, then LD_PRELOAD it. At MPI_Finalize each processor prints a line
 *     count_mpi RANK messages BYTES-OF-THEM all-reduces other-collectives seconds-outside-MPI
 * A call that another makes is counted once. */
#include <mpi.h>
#include <stdio.h>
#include <time.h>

static long long messages, bytes, reductions, collectives;
static double outside, left_at;
static int depth;

static double processor_time(void) {
  struct timespec t;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}
static int enter(void) {
  if (depth++ > 0) return 0;
  outside += processor_time() - left_at;
  return 1;
}
static int leave(int result) {
  if (--depth == 0) left_at = processor_time();
  return result;
}
static void sent(int count, MPI_Datatype type, int to) {
  int size;
  if (to == MPI_PROC_NULL) return;
  PMPI_Type_size(type, &size);
  ++messages;
  bytes += (long long)size * count;
}

int MPI_Send(const void* buffer, int n, MPI_Datatype type, int to, int tag, MPI_Comm comm) {
  if (enter()) sent(n, type, to);
  return leave(PMPI_Send(buffer, n, type, to, tag, comm));
}
int MPI_Rsend(const void* buffer, int n, MPI_Datatype type, int to, int tag, MPI_Comm comm) {
  if (enter()) sent(n, type, to);
  return leave(PMPI_Rsend(buffer, n, type, to, tag, comm));
}
int MPI_Isend(const void* buffer, int n, MPI_Datatype type, int to, int tag, MPI_Comm comm, MPI_Request* request) {
  if (enter()) sent(n, type, to);
  return leave(PMPI_Isend(buffer, n, type, to, tag, comm, request));
}
int MPI_Sendrecv(const void* out, int n, MPI_Datatype type, int to, int tag, void* in, int m, MPI_Datatype in_type,
                 int from, int in_tag, MPI_Comm comm, MPI_Status* status) {
  if (enter()) sent(n, type, to);
  return leave(PMPI_Sendrecv(out, n, type, to, tag, in, m, in_type, from, in_tag, comm, status));
}
int MPI_Irecv(void* buffer, int n, MPI_Datatype type, int from, int tag, MPI_Comm comm, MPI_Request* request) {
  enter();
  return leave(PMPI_Irecv(buffer, n, type, from, tag, comm, request));
}
int MPI_Recv(void* buffer, int n, MPI_Datatype type, int from, int tag, MPI_Comm comm, MPI_Status* status) {
  enter();
  return leave(PMPI_Recv(buffer, n, type, from, tag, comm, status));
}
int MPI_Wait(MPI_Request* request, MPI_Status* status) {
  enter();
  return leave(PMPI_Wait(request, status));
}
int MPI_Waitall(int n, MPI_Request* requests, MPI_Status* statuses) {
  enter();
  return leave(PMPI_Waitall(n, requests, statuses));
}
int MPI_Waitany(int n, MPI_Request* requests, int* which, MPI_Status* status) {
  enter();
  return leave(PMPI_Waitany(n, requests, which, status));
}
int MPI_Allreduce(const void* in, void* out, int n, MPI_Datatype type, MPI_Op op, MPI_Comm comm) {
  if (enter()) ++reductions;
  return leave(PMPI_Allreduce(in, out, n, type, op, comm));
}
int MPI_Reduce(const void* in, void* out, int n, MPI_Datatype type, MPI_Op op, int root, MPI_Comm comm) {
  if (enter()) ++collectives;
  return leave(PMPI_Reduce(in, out, n, type, op, root, comm));
}
int MPI_Bcast(void* buffer, int n, MPI_Datatype type, int root, MPI_Comm comm) {
  if (enter()) ++collectives;
  return leave(PMPI_Bcast(buffer, n, type, root, comm));
}
int MPI_Barrier(MPI_Comm comm) {
  if (enter()) ++collectives;
  return leave(PMPI_Barrier(comm));
}
int MPI_Init(int* argc, char*** argv) {
  const int result = PMPI_Init(argc, argv);
  left_at = processor_time();
  return result;
}
int MPI_Finalize(void) {
  int rank;
  enter();
  PMPI_Comm_rank(MPI_COMM_WORLD, &rank);
  printf("count_mpi %d %lld %lld %lld %lld %.6f\n", rank, messages, bytes, reductions, collectives, outside);
  fflush(stdout);
  return PMPI_Finalize();
}
