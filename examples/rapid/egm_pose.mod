MODULE EgmPose
    ! Follows targets of a host by Externally Guided Motion (EGM) in pose mode.
    ! Option needed: 3124-1 Externally Guided Motion (RobotWare 7) or 689-1 (RobotWare 6).
    ! Written after the application manual 3HAC073318; it was not loaded into a controller of ABB.
    !
    ! BEFORE THE FIRST RUN
    ! 1. Controller configuration (Communication, UDP Unicast Device, or "Transmission Protocol" with type
    !    UDPUC): name UCdevice, remote address = the host, remote port = 6510.
    ! 2. Motion configuration (External Motion Interface Data), the data named in EGMSetupUC:
    !    "Do Not Restart after Motors Off" = TRUE. With FALSE the robot continues by itself when the motors are
    !    switched on after an emergency stop, to an old target.
    !    Level = filtering (the default), default proportional position gain 5, default low pass 20 Hz.
    ! 3. Set toolHost and wobjHost below to what data/robots/*.toml of the host says. Wrong frames are wrong
    !    motions.
    ! 4. Set up a world zone (or SafeMove) around the work; EGM checks joint limits and singularities only.
    !
    ! SAFETY
    ! * The first runs: manual mode, reduced speed (250 mm/s), enabling device in hand, the speed knob of the
    !   host low, nobody within the fence. Automatic mode only with the fence closed.
    ! * The robot can move at any time, whenever the host sends another target. A message can be lost on its
    !   way: the robot then keeps its last target and its last speed reference, until \CommTimeout ends EGM.
    ! * A host that stops sending: \CommTimeout below, 0.2 s. A robot that stops sending: the host ends its
    !   path after 0.12 s and starts again only from where the robot is.
    ! * UDP has no authentication: give the robot and its host a network of their own.

    ! The tool and the work object of [tool] and [world] in the host's file. Position mm, quaternion w x y z.
    PERS tooldata toolHost := [TRUE, [[0,0,0],[1,0,0,0]], [5,[0,0,100],[1,0,0,0],0,0,0]];
    TASK PERS wobjdata wobjHost := [FALSE, TRUE, "", [[0,0,0],[1,0,0,0]], [[0,0,0],[1,0,0,0]]];

    ! Position at which EGM starts: teach it. The path of the host starts at the present position of the robot.
    CONST jointtarget jStart := [[0,0,0,0,30,0],[9E9,9E9,9E9,9E9,9E9,9E9]];

    VAR egmident egmId;
    ! All corrections are absolute poses in wobjHost.
    CONST pose noCorrection := [[0,0,0],[1,0,0,0]];
    ! A pose has converged within 0.1 mm and 0.1 degrees.
    CONST egm_minmax mmWindow := [-0.1, 0.1];
    CONST egm_minmax degreeWindow := [-0.1, 0.1];

    PROC main()
        ! EGM begins in a fine point, and not near a singularity.
        MoveAbsJ jStart \NoEOffs, v100, fine, toolHost \WObj:=wobjHost;
        EGMReset egmId;
        EGMGetId egmId;
        ! "default" names the External Motion Interface Data. \CommTimeout: s without a message of the host.
        EGMSetupUC ROB_1, egmId, "default", "UCdevice" \Pose \CommTimeout:=0.2;
        ! \MaxSpeedDeviation: degrees/s of a joint; its default of 1.0 hardly lets the robot move. Raise it with
        ! the speed of the work: rcs-run check --robot says what it must allow.
        ! \LpFilter in Hz: a lower one is smoother and lags more.
        ! \SampleRate: 4 ms, the host answers each message.
        EGMActPose egmId \StreamStart \Tool:=toolHost \WObj:=wobjHost,
            noCorrection, EGM_FRAME_WOBJ, noCorrection, EGM_FRAME_WOBJ
            \x:=mmWindow \y:=mmWindow \z:=mmWindow \rx:=degreeWindow \ry:=degreeWindow \rz:=degreeWindow
            \LpFilter:=20 \SampleRate:=4 \MaxSpeedDeviation:=30;
        ! Follow for an hour, whether the pose has converged or not; the host's speed references are used with
        ! the gain of the configuration.
        EGMRunPose egmId, EGM_STOP_RAMP_DOWN \x \y \z \rx \ry \rz \CondTime:=3600 \RampInTime:=0.5;
        EGMReset egmId;
    ERROR
        ! No message of the host in time: stop. The operator checks the robot and starts the program again.
        IF ERRNO = ERR_UDPUC_COMM THEN
            TPWrite "EGM: the host has sent nothing within 0.2 s";
        ELSE
            TPWrite "EGM: error " \Num:=ERRNO;
        ENDIF
        EGMReset egmId;
        Stop;
    ENDPROC
ENDMODULE
