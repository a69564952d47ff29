/* A law of the torque source next to a speed w with its state z, and where it ends:
   T = piece[0] + piece[1] w + piece[2] z, dz/dt = piece[3] + piece[4] w + piece[5] z. */
typedef struct {
  double piece[6];
  double edge[2];              /* z = edge[0] + edge[1] w while it slides along its limit */
  int slides, kind;            /* kind 0: it never ends */
  double side;                 /* of the limit */
} Regime;

