// SPDX-License-Identifier: Apache-2.0
// Functions that the library calls back. No exception may cross C: what they throw is kept, and
// becomes the InnerException of the error of the call.
using System;
using System.Collections.Generic;
using System.Runtime.InteropServices;
using System.Threading;
using Kiwami.Interop;

namespace Kiwami {

/// <summary>What a filter is asked about: a hit that TMin, TMax, masks and sides leave.</summary>
public struct FilterCandidate {
  /// <summary>The number of the ray in the call.</summary>
  public ulong Ray { get; internal set; }
  public Hit Hit { get; internal set; }
  /// <summary>The numbers of the instances that lead to the hit, the outermost first.</summary>
  public uint[] InstancePath { get; internal set; }
}

/// <summary>What a filter says.</summary>
public enum FilterAnswer {
  Reject = (int)Native.KIWAMI_FILTER_REJECT,
  Accept = (int)Native.KIWAMI_FILTER_ACCEPT,
  /// <summary>Nothing more is looked for along this ray.</summary>
  AcceptAndStop = (int)Native.KIWAMI_FILTER_ACCEPT_AND_STOP
}

/// <summary>Decides whether a hit counts. Several threads ask it at once.</summary>
public delegate FilterAnswer Filter(FilterCandidate candidate);

/// <summary>Which threads of the program are in the library. Its own threads become threads of the
/// runtime with their first callback. When a program ends, Mono waits for all of these to end as well,
/// which the library's never do: so it is ended first, as Environment.Exit would.</summary>
internal static class CallingThread {
  [ThreadStatic]
  static int depth;
  static int isEndWatched;

  public static void Enter() {
    ++depth;
  }
  public static void Leave() {
    --depth;
  }

  /// <summary>The first thing that every callback does.</summary>
  public static void BeginCallback() {
    if (depth != 0 || Interlocked.Exchange(ref isEndWatched, 1) != 0) return;
    if (Type.GetType("Mono.Runtime") == null) return;
    AppDomain.CurrentDomain.ProcessExit += (sender, arguments) => Exit(Environment.ExitCode);
  }

  [DllImport("libc", EntryPoint = "exit", CallingConvention = CallingConvention.Cdecl)]
  static extern void Exit(int code);
}

/// <summary>What a callback finds by its user pointer, for the length of one call.</summary>
internal abstract class RunningCallback : IDisposable {
  GCHandle self;
  Exception thrown;

  protected RunningCallback() {
    self = GCHandle.Alloc(this);
  }
  public IntPtr User {
    get { return GCHandle.ToIntPtr(self); }
  }
  /// <summary>The first exception of the callbacks, which may run on several threads.</summary>
  public Exception Thrown {
    get { return Volatile.Read(ref thrown); }
  }
  protected void Keep(Exception exception) {
    Interlocked.CompareExchange(ref thrown, exception, null);
  }
  public void Dispose() {
    self.Free();
  }
}

internal sealed class RunningFilter : RunningCallback {
  // The library may call a delegate only while something holds it: these are held for ever.
  static readonly kiwami_filter_function decide = Decide;
  public static readonly IntPtr Function = Marshal.GetFunctionPointerForDelegate(decide);

  static readonly uint[] noInstances = new uint[0];
  readonly Filter filter;

  public RunningFilter(Filter filter) {
    this.filter = filter;
  }

  static unsafe int Decide(IntPtr user, IntPtr address) {
    var running = (RunningFilter)GCHandle.FromIntPtr(user).Target;
    if (running.Thrown != null) return -1;
    try {
      CallingThread.BeginCallback();
      var asked = (kiwami_filter_candidate*)address;
      var path = asked->depth == 0 ? noInstances : new uint[asked->depth];
      for (int i = 0; i < path.Length; ++i) path[i] = asked->instance_path[i];
      return (int)running.filter(new FilterCandidate {
        Ray = asked->ray, Hit = *(Hit*)&asked->hit, InstancePath = path
      });
    } catch (Exception exception) {
      running.Keep(exception);
      return -1;
    }
  }
}

internal sealed class RunningProgress : RunningCallback {
  static readonly kiwami_progress report = Report;
  public static readonly IntPtr Function = Marshal.GetFunctionPointerForDelegate(report);

  readonly Func<double, bool> progress;

  public RunningProgress(Func<double, bool> progress) {
    this.progress = progress;
  }

  static int Report(IntPtr user, double fraction) {
    var running = (RunningProgress)GCHandle.FromIntPtr(user).Target;
    if (running.Thrown != null) return 1;
    try {
      CallingThread.BeginCallback();
      return running.progress(fraction) ? 1 : 0;
    } catch (Exception exception) {
      running.Keep(exception);
      return 1;
    }
  }
}

/// <summary>What user geometries throw. The library does not say for which call they run, so it is
/// kept for all calls that do: one that fails has the first since it began.</summary>
internal static class UserErrors {
  struct Kept {
    public ulong When;
    public Exception Exception;
  }

  static readonly object gate = new object();
  static readonly List<Kept> kept = new List<Kept>();
  static int running;
  static ulong clock, lastBegin;
  static int geometryCount;

  /// <summary>User geometries begin and end; without any no call need be counted.</summary>
  public static void Count(int change) {
    Interlocked.Add(ref geometryCount, change);
  }

  public static void Keep(Exception exception) {
    lock (gate) {
      if (kept.Count == 0 || kept[kept.Count - 1].When < lastBegin) {
        kept.Add(new Kept { When = ++clock, Exception = exception });
      }
    }
  }

  public static Call Begin() {
    return new Call(Volatile.Read(ref geometryCount) != 0);
  }

  /// <summary>A call that may run callbacks of user geometries.</summary>
  public struct Call : IDisposable {
    readonly bool isCounted;
    readonly ulong begin;

    public Call(bool isCounted) {
      this.isCounted = isCounted;
      begin = 0;
      if (!isCounted) return;
      lock (gate) {
        ++running;
        begin = lastBegin = ++clock;
      }
    }

    /// <summary>The first exception since the call began, or null.</summary>
    public Exception First {
      get {
        if (!isCounted) return null;
        lock (gate) {
          foreach (Kept each in kept) {
            if (each.When > begin) return each.Exception;
          }
        }
        return null;
      }
    }

    public void Dispose() {
      if (!isCounted) return;
      lock (gate) {
        if (--running == 0) kept.Clear();
      }
    }
  }
}

}
